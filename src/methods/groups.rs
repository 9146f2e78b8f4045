//! Independent groups of samples: how many, and the mean and standard error of their images.

use super::stage::Stage;
use crate::paths::film::filter::Block;
use crate::room::{self, NoRoom};
use crate::scene::Rgb;

/// Independent groups of samples behind a standard error, at least.
const MIN_GROUPS: u32 = 4;

/// The groups behind standard errors of `spp` samples a pixel.
pub fn group_count(spp: u32) -> u32 {
    equal_groups(spp, MIN_GROUPS)
}

/// The smallest number of equal groups of `spp` samples that is at least `least`, or one sample each.
pub fn equal_groups(spp: u32, least: u32) -> u32 {
    (least..=spp)
        .find(|g| spp.is_multiple_of(*g))
        .unwrap_or(spp)
}

/// The mean of equally weighted images of independent groups, and its standard error.
pub struct GroupMean {
    sum: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
    groups: u32,
}

impl GroupMean {
    /// Of `groups` images of so many pixels.
    pub fn new(pixels: usize, groups: u32) -> Result<Self, NoRoom> {
        Ok(Self {
            sum: room::filled([0.0; 3], pixels)?,
            squares: room::filled([0.0; 3], if groups > 1 { pixels } else { 0 })?,
            groups,
        })
    }

    /// Adds an image; the order of the calls is the order of summation.
    pub fn add(&mut self, image: &[Rgb]) {
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
    pub fn finish(self) -> Result<(Vec<Rgb>, Option<Vec<Rgb>>), NoRoom> {
        let n = self.groups as f64;
        let mut mean = room::empty(self.sum.len())?;
        mean.extend(self.sum.iter().map(|s| s.map(|x| (x / n) as f32)));
        if self.groups < 2 {
            return Ok((mean, None));
        }
        let se = |s: f64, q: f64| (((q - s * s / n) / (n - 1.0)).max(0.0) / n).sqrt() as f32;
        let mut error = room::empty(self.sum.len())?;
        let sums = self.sum.iter().zip(&self.squares);
        error.extend(sums.map(|(s, q)| std::array::from_fn(|c| se(s[c], q[c]))));
        Ok((mean, Some(error)))
    }
}

/// A [`GroupMean`] of images that come tile by tile.
pub struct GroupImages {
    width: usize,
    group: Option<u32>,
    current: Vec<Rgb>,
    mean: GroupMean,
}

impl GroupImages {
    pub fn new(stage: &Stage) -> Result<Self, NoRoom> {
        let pixels = stage.size[0] * stage.size[1];
        Ok(Self {
            width: stage.size[0],
            group: None,
            current: room::filled([0.0; 3], pixels)?,
            mean: GroupMean::new(pixels, stage.own_groups().len() as u32)?,
        })
    }

    /// Adds a tile's part to the image of `group`; groups come one after another.
    pub fn add(&mut self, group: u32, block: &Block) {
        if self.group.is_some_and(|before| before != group) {
            self.close();
        }
        self.group = Some(group);
        block.add_to(&mut self.current, self.width);
    }

    fn close(&mut self) {
        self.mean.add(&self.current);
        self.current.fill([0.0; 3]);
    }

    /// Mean and standard error (if there are several groups).
    pub fn finish(mut self) -> Result<(Vec<Rgb>, Option<Vec<Rgb>>), NoRoom> {
        self.close();
        self.mean.finish()
    }
}
