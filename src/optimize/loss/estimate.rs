//! The loss of an image that is noisy, how sure it is, and what noise alone would make it.

use super::Comparison;
use crate::picture::Image;

/// What a rendering says of the loss.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LossEstimate {
    /// Of the mean of all groups of samples.
    pub value: f64,
    /// Its standard error, by leaving out one group at a time; not known of one group.
    pub error: Option<f64>,
    /// What it would be, were the image without noise the target: that of the noise alone.
    pub floor: Option<f64>,
}

/// The mean of the groups' images, its loss, and the derivative by it.
pub fn estimate(comparison: &Comparison, groups: &[Image]) -> (LossEstimate, Image, Image) {
    let mean = mean(groups.iter());
    let (value, adjoint) = comparison.differentiate(&mean);
    let estimate = LossEstimate {
        value,
        error: jackknife(comparison, groups),
        floor: floor(comparison, groups),
    };
    (estimate, mean, adjoint)
}

/// The mean of images of one size.
fn mean<'a>(images: impl Iterator<Item = &'a Image> + Clone) -> Image {
    let count = images.clone().count() as f64;
    let mut sums: Vec<[f64; 3]> = Vec::new();
    let mut size = [0; 2];
    for image in images {
        size = [image.width, image.height];
        sums.resize(image.pixels.len(), [0.0; 3]);
        for (sum, pixel) in sums.iter_mut().zip(&image.pixels) {
            *sum = [0, 1, 2].map(|c| sum[c] + f64::from(pixel[c]));
        }
    }
    Image {
        width: size[0],
        height: size[1],
        pixels: sums.iter().map(|s| s.map(|v| (v / count) as f32)).collect(),
    }
}

/// The jackknife's standard error of a function of means [Efron1993] (ch. 11).
fn jackknife(comparison: &Comparison, groups: &[Image]) -> Option<f64> {
    let n = groups.len();
    if n < 2 {
        return None;
    }
    let without = |out: usize| {
        let rest = groups.iter().enumerate().filter(move |(i, _)| *i != out);
        comparison.measure(&mean(rest.map(|(_, image)| image)))
    };
    let losses: Vec<f64> = (0..n).map(without).collect();
    let middle = losses.iter().sum::<f64>() / n as f64;
    let squares: f64 = losses.iter().map(|loss| (loss - middle).powi(2)).sum();
    Some((squares * (n - 1) as f64 / n as f64).sqrt())
}

/// Half the difference of two halves is noise as large as that of their mean, and has no signal.
fn floor(comparison: &Comparison, groups: &[Image]) -> Option<f64> {
    let half = groups.len() / 2;
    if half == 0 {
        return None;
    }
    let (first, second) = (
        mean(groups[..half].iter()),
        mean(groups[half..2 * half].iter()),
    );
    let target = comparison.target();
    // Of an odd number of groups one is not used, and the noise is that of the others.
    let scale = 0.5 * ((2 * half) as f32 / groups.len() as f32).sqrt();
    let pixels = target
        .pixels
        .iter()
        .zip(first.pixels.iter().zip(&second.pixels));
    let noisy = Image {
        width: target.width,
        height: target.height,
        pixels: pixels
            .map(|(t, (a, b))| [0, 1, 2].map(|c| t[c] + scale * (a[c] - b[c])))
            .collect(),
    };
    Some(comparison.measure(&noisy))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::optimize::config::Pointwise;

    /// Normal numbers enough: sums of twelve uniform ones.
    fn noise(count: usize, seed: u64) -> Vec<f32> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut uniform = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 40) as f64 / (1u64 << 24) as f64
        };
        (0..count)
            .map(|_| ((0..12).map(|_| uniform()).sum::<f64>() - 6.0) as f32)
            .collect()
    }

    fn group(seed: u64, signal: f32, sigma: f32) -> Image {
        let noise = noise(3 * 256, seed);
        let pixels = noise.as_chunks::<3>().0.iter();
        Image {
            width: 16,
            height: 16,
            pixels: pixels
                .map(|n| n.map(|n| 1.0 + signal + sigma * n))
                .collect(),
        }
    }

    #[test]
    fn errors_and_floors_are_those_of_many_runs() {
        let target = group(0, 0.0, 0.0);
        for kind in [Pointwise::L1, Pointwise::L2] {
            let comparison = Comparison::new(kind, target.clone(), None, 1);
            let run = |seed: u64, signal| {
                let groups: Vec<Image> = (0..4)
                    .map(|g| group(4 * seed + g + 1, signal, 0.2))
                    .collect();
                estimate(&comparison, &groups).0
            };
            let runs: Vec<LossEstimate> = (0..200).map(|seed| run(seed, 0.3)).collect();
            let n = runs.len() as f64;
            let mean = runs.iter().map(|r| r.value).sum::<f64>() / n;
            let spread = runs.iter().map(|r| (r.value - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let stated = runs.iter().map(|r| r.error.unwrap().powi(2)).sum::<f64>() / n;
            // A variance of 200 runs is known to a tenth; four groups tell each one to 0.8.
            let z = (stated / spread - 1.0) / (0.1f64.powi(2) + 0.82f64.powi(2) / n).sqrt();
            assert!(z.abs() < 4.0, "{kind:?}: {stated} {spread}");
            // Without a signal, the loss is its floor.
            let silent: Vec<LossEstimate> = (0..200).map(|seed| run(seed, 0.0)).collect();
            let apart: Vec<f64> = silent.iter().map(|r| r.value - r.floor.unwrap()).collect();
            let apart = crate::statistics::estimate::Estimate::mean(&apart);
            assert!(apart.z(0.0).abs() < 4.0, "{kind:?}: {apart:?}");
            assert!(apart.error < 0.01 * silent[0].value);
        }
    }
}
