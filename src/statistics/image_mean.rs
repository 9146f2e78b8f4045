//! The mean of images that come one after another.

use super::estimate::error_of_mean;
use crate::room::{self, NoRoom};

/// Pixels of the mean, and their standard errors if there are several images.
pub type MeanAndError = (Vec<[f32; 3]>, Option<Vec<[f32; 3]>>);

/// The mean of equally weighted images of independent groups, and its standard error.
pub struct ImageMean {
    sum: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
    groups: u32,
}

impl ImageMean {
    /// Of `groups` images of so many pixels.
    pub fn new(pixels: usize, groups: u32) -> Result<Self, NoRoom> {
        Ok(Self {
            sum: room::filled([0.0; 3], pixels)?,
            squares: room::filled([0.0; 3], if groups > 1 { pixels } else { 0 })?,
            groups,
        })
    }

    /// Adds an image; the order of the calls is the order of summation.
    pub fn add(&mut self, image: &[[f32; 3]]) {
        for (i, pixel) in image.iter().enumerate() {
            for c in 0..3 {
                let value = pixel[c] as f64;
                self.sum[i][c] += value;
                if let Some(squares) = self.squares.get_mut(i) {
                    squares[c] += value * value;
                }
            }
        }
    }

    /// Mean and standard error (if there are several groups).
    pub fn finish(self) -> Result<MeanAndError, NoRoom> {
        let n = self.groups as f64;
        let mut mean = room::empty(self.sum.len())?;
        mean.extend(self.sum.iter().map(|s| s.map(|x| (x / n) as f32)));
        if self.groups < 2 {
            return Ok((mean, None));
        }
        // One pass has no mean yet to take distances from; rounding may leave less than nothing.
        let se = |s: f64, q: f64| error_of_mean((q - s * s / n).max(0.0), n) as f32;
        let mut error = room::empty(self.sum.len())?;
        let sums = self.sum.iter().zip(&self.squares);
        error.extend(sums.map(|(s, q)| std::array::from_fn(|c| se(s[c], q[c]))));
        Ok((mean, Some(error)))
    }
}
