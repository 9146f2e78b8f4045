//! The mean of the images of groups of samples, which come tile by tile.

use crate::paths::film::filter::Block;
use crate::room::{self, NoRoom};
use crate::scene::Rgb;
use crate::statistics::image_mean::{ImageMean, MeanAndError};

/// A [`ImageMean`] of images that come tile by tile.
pub struct GroupImages {
    width: usize,
    group: Option<u32>,
    current: Vec<Rgb>,
    mean: ImageMean,
}

impl GroupImages {
    /// Of `groups` images of this size.
    pub fn new([width, height]: [usize; 2], groups: u32) -> Result<Self, NoRoom> {
        let pixels = width * height;
        Ok(Self {
            width,
            group: None,
            current: room::filled([0.0; 3], pixels)?,
            mean: ImageMean::new(pixels, groups)?,
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
    pub fn finish(mut self) -> Result<MeanAndError, NoRoom> {
        self.close();
        self.mean.finish()
    }
}
