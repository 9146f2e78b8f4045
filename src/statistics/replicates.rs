//! Independent runs of one estimator, added up: their mean and how sure it is, by pixel and by
//! block.

use super::estimate::Estimate;
use crate::picture::Image;

/// Side of the squares of pixels that are also compared as one: errors within a filter's reach are
/// correlated, and what is too noisy in a pixel shows in the mean of many.
pub const BLOCK: usize = 8;

/// Gradient images of independent runs.
#[derive(Clone, Debug, Default)]
pub struct Replicates {
    width: usize,
    height: usize,
    runs: usize,
    /// Sums over runs, number by number: the values, and the squares of their standard errors.
    sum: Vec<f64>,
    variance: Vec<f64>,
    /// Every run's block means, channel by channel.
    blocks: Vec<Vec<f64>>,
}

impl Replicates {
    /// Adds a run, of the size of all others.
    pub fn add(&mut self, value: &Image, stderr: &Image) {
        (self.width, self.height) = (value.width, value.height);
        self.runs += 1;
        self.sum.resize(3 * value.pixels.len(), 0.0);
        self.variance.resize(3 * value.pixels.len(), 0.0);
        for (sum, v) in self.sum.iter_mut().zip(value.pixels.iter().flatten()) {
            *sum += *v as f64;
        }
        for (sum, e) in self.variance.iter_mut().zip(stderr.pixels.iter().flatten()) {
            *sum += (*e as f64).powi(2);
        }
        let mut blocks = vec![0.0; 3 * self.block_count()];
        let mut counts = vec![0u32; 3 * self.block_count()];
        for (at, v) in value.pixels.iter().flatten().enumerate() {
            let block = 3 * self.block_of(at) + at % 3;
            blocks[block] += *v as f64;
            counts[block] += 1;
        }
        for (mean, count) in blocks.iter_mut().zip(counts) {
            *mean /= f64::from(count.max(1));
        }
        self.blocks.push(blocks);
    }

    pub fn runs(&self) -> usize {
        self.runs
    }

    pub fn width(&self) -> usize {
        self.width
    }

    /// Blocks of the image.
    pub fn block_count(&self) -> usize {
        self.width.div_ceil(BLOCK) * self.height.div_ceil(BLOCK)
    }

    /// The block of number `at` (three a pixel, row by row).
    pub fn block_of(&self, at: usize) -> usize {
        let (x, y) = (at / 3 % self.width, at / 3 / self.width);
        y / BLOCK * self.width.div_ceil(BLOCK) + x / BLOCK
    }

    /// Mean and standard error of every number.
    pub fn numbers(&self) -> impl Iterator<Item = (f64, f64)> {
        let n = self.runs.max(1) as f64;
        let pairs = self.sum.iter().zip(&self.variance);
        pairs.map(move |(sum, variance)| (sum / n, variance.sqrt() / n))
    }

    /// Mean and standard error of every block and channel, the errors from the scatter of the runs.
    pub fn block_means(&self) -> impl Iterator<Item = Estimate> {
        (0..3 * self.block_count())
            .map(|b| Estimate::mean_of(self.blocks.iter().map(move |run| run[b])))
    }

    /// The mean.
    pub fn mean(&self) -> Image {
        self.image(self.numbers().map(|(value, _)| value))
    }

    /// An image of this size.
    pub fn image(&self, numbers: impl Iterator<Item = f64>) -> Image {
        let numbers: Vec<f32> = numbers.map(|v| v as f32).collect();
        Image {
            width: self.width,
            height: self.height,
            pixels: numbers.as_chunks::<3>().0.to_vec(),
        }
    }
}
