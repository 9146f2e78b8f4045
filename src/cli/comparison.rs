//! Statistics of gradient images: how far two estimates are from each other, in their own error bars.

use crate::methods::Image;
use serde::Serialize;

/// Side of the squares of pixels within which errors may be correlated: a sample is splatted over the
/// reconstruction filter, whose widest here reaches a few pixels.
const BLOCK: usize = 8;

/// Differences below this share of the largest number are rounding.
const ROUNDING: f64 = 1e-4;

/// A gradient image with its standard errors.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    pub value: &'a Image,
    pub stderr: &'a Image,
}

/// Two independent estimates of one gradient image, compared.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    /// Numbers (pixels × channels) where either estimate has anything to say.
    pub compared: usize,
    /// Σz²/N, 1 if they agree and their error bars are right.
    pub chi2_per_number: f64,
    /// The share of numbers more than four standard errors apart; 0.00006 for a normal distribution.
    pub share_beyond_4: f64,
    pub largest_z: f64,
    /// Where `largest_z` is: x, y, channel.
    pub largest_z_at: [usize; 3],
    /// Numbers that differ although both error bars are zero.
    pub certain_differences: usize,
    /// ⟨value − reference, reference⟩ / ⟨reference, reference⟩, freed of the reference's own noise.
    pub relative_bias: f64,
    pub relative_bias_se: f64,
    /// RMS of the difference that error bars do not explain, relative to the reference's RMS.
    pub relative_excess: f64,
    pub reference_rms: f64,
    /// Whether the reference stands out of its own noise at all.
    pub reference_is_significant: bool,
}

impl Comparison {
    /// Compares `tested` with `reference`, images of one size.
    pub fn of(tested: Estimate, reference: Estimate) -> Self {
        let (width, channels) = (tested.value.width, 3);
        let mut sums = Sums::default();
        let mut largest = (0.0, 0);
        let mut certain_differences = 0;
        // Rounding in a renderer, and all the more in a difference quotient, has no error bar.
        let rounding =
            ROUNDING * largest_magnitude(tested.value).max(largest_magnitude(reference.value));
        for (at, [a, sa, b, sb]) in quadruples(tested, reference).enumerate() {
            let variance = sa * sa + sb * sb;
            if variance == 0.0 && a == 0.0 && b == 0.0 {
                continue;
            }
            sums.compared += 1;
            if variance == 0.0 {
                certain_differences += usize::from((a - b).abs() > rounding);
            } else {
                let z = (a - b) / variance.sqrt();
                sums.chi2 += z * z;
                sums.beyond += usize::from(z.abs() > 4.0);
                if z.abs() > largest.0 {
                    largest = (z.abs(), at);
                }
            }
            sums.ab += a * b;
            sums.bb += b * b;
            sums.noise_b += sb * sb;
            sums.difference += (a - b).powi(2);
            sums.noise += variance;
            sums.noise_on_b += variance * b * b;
        }
        let signal = (sums.bb - sums.noise_b).max(0.0);
        let significant = signal > 0.1 * sums.bb;
        // Without a signal nothing is relative to it.
        let scale = if significant { signal } else { f64::NAN };
        let bias = (sums.ab - sums.bb + sums.noise_b) / scale;
        let clustered = clustered_variance(tested, reference, bias);
        let count = sums.compared.max(1) as f64;
        let pixel = largest.1 / channels;
        Self {
            compared: sums.compared,
            chi2_per_number: sums.chi2 / count,
            share_beyond_4: sums.beyond as f64 / count,
            largest_z: largest.0,
            largest_z_at: [
                pixel % width.max(1),
                pixel / width.max(1),
                largest.1 % channels,
            ],
            certain_differences,
            relative_bias: bias,
            relative_bias_se: clustered.max(sums.noise_on_b).sqrt() / scale,
            relative_excess: ((sums.difference - sums.noise).max(0.0) / scale).sqrt(),
            reference_rms: (signal / tested.value.pixels.len().max(1) as f64 / channels as f64)
                .sqrt(),
            reference_is_significant: significant,
        }
    }
}

#[derive(Default)]
struct Sums {
    compared: usize,
    beyond: usize,
    chi2: f64,
    ab: f64,
    bb: f64,
    noise_b: f64,
    difference: f64,
    noise: f64,
    noise_on_b: f64,
}

/// Tested value and error, reference value and error, number by number.
fn quadruples<'a>(
    tested: Estimate<'a>,
    reference: Estimate<'a>,
) -> impl Iterator<Item = [f64; 4]> + 'a {
    let flat = |image: &'a Image| image.pixels.iter().flatten().map(|v| *v as f64);
    let values = flat(tested.value).zip(flat(tested.stderr));
    values
        .zip(flat(reference.value).zip(flat(reference.stderr)))
        .map(|((a, sa), (b, sb))| [a, sa, b, sb])
}

/// The variance of ⟨tested − reference, reference⟩ from its scatter over blocks, which holds although
/// neighbouring pixels share samples; the bias itself is taken out first.
fn clustered_variance(tested: Estimate, reference: Estimate, bias: f64) -> f64 {
    let width = tested.value.width;
    let columns = width.div_ceil(BLOCK).max(1);
    let mut blocks = vec![0.0; columns * tested.value.height.div_ceil(BLOCK).max(1)];
    let bias = if bias.is_finite() { bias } else { 0.0 };
    for (at, [a, _, b, sb]) in quadruples(tested, reference).enumerate() {
        let (x, y) = (at / 3 % width, at / 3 / width);
        blocks[y / BLOCK * columns + x / BLOCK] +=
            (a - (1.0 + bias) * b) * b + (1.0 + bias) * sb * sb;
    }
    blocks.iter().map(|block| block * block).sum()
}

/// The difference in standard errors; zero where neither estimate has one.
pub fn z_scores(tested: Estimate, reference: Estimate) -> Image {
    let numbers: Vec<f32> = quadruples(tested, reference)
        .map(|[a, sa, b, sb]| {
            if sa == 0.0 && sb == 0.0 {
                0.0
            } else {
                ((a - b) / sa.hypot(sb)) as f32
            }
        })
        .collect();
    Image {
        width: tested.value.width,
        height: tested.value.height,
        pixels: numbers.as_chunks::<3>().0.to_vec(),
    }
}

fn largest_magnitude(image: &Image) -> f64 {
    image
        .pixels
        .iter()
        .flatten()
        .fold(0.0, |largest, v| largest.max(v.abs() as f64))
}

/// The root of the mean square over pixels and channels.
pub fn rms(image: &Image) -> f64 {
    let sum: f64 = image
        .pixels
        .iter()
        .flatten()
        .map(|v| (*v as f64).powi(2))
        .sum();
    (sum / (3 * image.pixels.len()).max(1) as f64).sqrt()
}

/// The standard error of the mean of independent, equally weighted estimates, number by number.
pub fn standard_error(groups: &[Vec<f32>]) -> Vec<f32> {
    let n = groups.len() as f64;
    let numbers = groups.first().map_or(0, Vec::len);
    (0..numbers)
        .map(|i| {
            let mean = groups.iter().map(|group| group[i] as f64).sum::<f64>() / n;
            let squares: f64 = groups
                .iter()
                .map(|group| (group[i] as f64 - mean).powi(2))
                .sum();
            (squares / (n - 1.0) / n).sqrt() as f32
        })
        .collect()
}

#[cfg(test)]
#[path = "comparison_tests.rs"]
mod tests;
