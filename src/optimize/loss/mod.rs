//! What is made small: an image compared with its target, at several resolutions, where its mask
//! lets it count.

mod estimate;
mod pointwise;

pub use estimate::{LossEstimate, estimate};

use super::config::Pointwise;
use crate::picture::Image;

/// A target with what a comparison needs of it.
#[derive(Clone, Debug)]
pub struct Comparison {
    kind: Pointwise,
    size: [usize; 2],
    target: Image,
    /// One a pixel, from 0 to 1.
    weights: Option<Vec<f32>>,
    levels: Vec<Level>,
}

/// The target at one resolution.
#[derive(Clone, Debug)]
struct Level {
    /// Side of the squares of pixels that are one here.
    side: usize,
    size: [usize; 2],
    /// Weighted means, and the weights of the squares, whose sum is one.
    target: Vec<[f64; 3]>,
    weights: Vec<f64>,
}

impl Comparison {
    /// Of so many levels, the first of them the image itself. Fewer where the image is too small.
    pub fn new(kind: Pointwise, target: Image, weights: Option<Vec<f32>>, levels: u32) -> Self {
        let size = [target.width, target.height];
        let most = size[0].min(size[1]).max(1).ilog2() + 1;
        let mut made = Self {
            kind,
            size,
            target,
            weights,
            levels: Vec::new(),
        };
        for level in 0..levels.min(most) {
            let side = 1 << level;
            let size = size.map(|n: usize| n.div_ceil(side));
            let weights = made.square_weights(side, size);
            let sum: f64 = weights.iter().sum();
            let scale = if sum > 0.0 { 1.0 / sum } else { 0.0 };
            let target = made.squares(&made.target, side, size, &weights);
            made.levels.push(Level {
                side,
                size,
                target,
                weights: weights.into_iter().map(|w| w * scale).collect(),
            });
        }
        made
    }

    /// The target.
    pub fn target(&self) -> &Image {
        &self.target
    }

    /// The mask, if there is one.
    pub fn weights(&self) -> Option<&[f32]> {
        self.weights.as_deref()
    }

    /// Weight of a pixel.
    fn weight(&self, at: usize) -> f64 {
        self.weights.as_ref().map_or(1.0, |w| f64::from(w[at]))
    }

    fn square_weights(&self, side: usize, size: [usize; 2]) -> Vec<f64> {
        let mut sums = vec![0.0; size[0] * size[1]];
        for (at, square) in self.pixels(side, size) {
            sums[square] += self.weight(at);
        }
        sums
    }

    /// Each pixel with its square.
    fn pixels(&self, side: usize, size: [usize; 2]) -> impl Iterator<Item = (usize, usize)> {
        let width = self.size[0];
        let all = 0..width * self.size[1];
        all.map(move |at| (at, at / width / side * size[0] + at % width / side))
    }

    fn squares(
        &self,
        image: &Image,
        side: usize,
        size: [usize; 2],
        weights: &[f64],
    ) -> Vec<[f64; 3]> {
        let mut means = vec![[0.0; 3]; size[0] * size[1]];
        for (at, square) in self.pixels(side, size) {
            let weight = self.weight(at);
            for (mean, value) in means[square].iter_mut().zip(image.pixels[at]) {
                *mean += weight * f64::from(value);
            }
        }
        for (mean, weight) in means.iter_mut().zip(weights) {
            let scale = if *weight > 0.0 { 1.0 / weight } else { 0.0 };
            *mean = mean.map(|v| v * scale);
        }
        means
    }

    /// The loss of an image of the target's size: the mean over levels, of the mean over pixels by
    /// their weights, and over channels.
    pub fn measure(&self, image: &Image) -> f64 {
        self.differentiate(image).0
    }

    /// The loss, and its derivative by the image.
    pub fn differentiate(&self, image: &Image) -> (f64, Image) {
        let mut loss = 0.0;
        let mut slopes = vec![[0.0f64; 3]; image.pixels.len()];
        let share = 1.0 / (3 * self.levels.len()) as f64;
        for level in &self.levels {
            let sums = self.square_weights(level.side, level.size);
            let means = self.squares(image, level.side, level.size, &sums);
            let mut bars = vec![[0.0; 3]; means.len()];
            for (i, mean) in means.iter().enumerate() {
                for c in 0..3 {
                    let (value, slope) = pointwise::of(self.kind, mean[c], level.target[i][c]);
                    loss += share * level.weights[i] * value;
                    bars[i][c] = share * level.weights[i] * slope;
                }
            }
            for (at, square) in self.pixels(level.side, level.size) {
                let part = match sums[square] > 0.0 {
                    true => self.weight(at) / sums[square],
                    false => 0.0,
                };
                for c in 0..3 {
                    slopes[at][c] += part * bars[square][c];
                }
            }
        }
        let pixels = slopes.iter().map(|s| s.map(|v| v as f32)).collect();
        let adjoint = Image {
            width: image.width,
            height: image.height,
            pixels,
        };
        (loss, adjoint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(size: [usize; 2], seed: u32) -> Image {
        let number = |i: usize| {
            let mut h = (i as u32 + 1).wrapping_mul(0x9e37_79b1) ^ seed.wrapping_mul(0x85eb_ca6b);
            h ^= h >> 15;
            h = h.wrapping_mul(0x2c1b_3c6d);
            (h >> 8) as f32 / (1 << 24) as f32
        };
        let pixels = (0..size[0] * size[1])
            .map(|p| [0, 1, 2].map(|c| 0.1 + number(3 * p + c)))
            .collect();
        Image {
            width: size[0],
            height: size[1],
            pixels,
        }
    }

    #[test]
    fn every_loss_has_the_derivative_of_its_differences() {
        let kinds = [
            Pointwise::L1,
            Pointwise::L2,
            Pointwise::RelativeL2,
            Pointwise::Log,
        ];
        let size = [7, 5];
        let weights: Vec<f32> = image(size, 9)
            .pixels
            .iter()
            .map(|p| p[0].min(1.0))
            .collect();
        for kind in kinds {
            for (levels, weights) in [(1, None), (3, Some(weights.clone()))] {
                let comparison = Comparison::new(kind, image(size, 1), weights, levels);
                let mut at = image(size, 2);
                let (_, adjoint) = comparison.differentiate(&at);
                for pixel in [0, 6, 17, 34] {
                    // The step is what single precision makes of it.
                    let here = at.pixels[pixel][1];
                    let (low, high) = (here - 1e-3, here + 1e-3);
                    at.pixels[pixel][1] = high;
                    let above = comparison.measure(&at);
                    at.pixels[pixel][1] = low;
                    let below = comparison.measure(&at);
                    at.pixels[pixel][1] = here;
                    let slope = (above - below) / (f64::from(high) - f64::from(low));
                    let found = f64::from(adjoint.pixels[pixel][1]);
                    assert!(
                        (slope - found).abs() < 1e-5 * (slope.abs() + 1e-3),
                        "{kind:?} {levels} {pixel}: {slope} {found}"
                    );
                }
            }
        }
    }

    #[test]
    fn known_values() {
        let of = |kind, value: f32, target: f32| {
            let make = |v| Image {
                width: 2,
                height: 2,
                pixels: vec![[v; 3]; 4],
            };
            Comparison::new(kind, make(target), None, 2).measure(&make(value))
        };
        assert!((of(Pointwise::L1, 0.5, 2.0) - 1.5).abs() < 1e-12);
        assert!((of(Pointwise::L2, 0.5, 2.0) - 2.25).abs() < 1e-12);
        assert!((of(Pointwise::RelativeL2, 0.5, 2.0) - 2.25 / 4.01).abs() < 1e-9);
        let log = (1.5f64.ln() - 3f64.ln()).powi(2);
        assert!((of(Pointwise::Log, 0.5, 2.0) - log).abs() < 1e-12);
    }

    #[test]
    fn what_the_mask_hides_does_not_count() {
        let (a, mut b) = (image([4, 4], 1), image([4, 4], 1));
        b.pixels[5] = [9.0; 3];
        let mut weights = vec![1.0; 16];
        weights[5] = 0.0;
        let comparison = Comparison::new(Pointwise::L2, a, Some(weights), 3);
        let (loss, adjoint) = comparison.differentiate(&b);
        assert!(loss < 1e-14 && adjoint.pixels[5] == [0.0; 3], "{loss}");
    }
}
