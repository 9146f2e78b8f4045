//! Photographs and masks.

use crate::jobs::failure::Failure;
use crate::output::FileError;
use crate::output::picture::PictureFile;
use crate::picture::{self, Colours, Image};
use std::path::Path;

/// A target: integers are sRGB and become linear, floating-point numbers are linear.
pub fn image(file: &Path) -> Result<Image, Failure> {
    Ok(PictureFile::open(file)?.read()?)
}

/// A mask: the mean of the channels, not decoded, from 0 (does not count) to 1.
pub fn mask(file: &Path, size: [usize; 2]) -> Result<Vec<f32>, Failure> {
    let read = picture::read(file, Colours::Raw).map_err(FileError::from)?;
    check(file, [read.width as usize, read.height as usize], size)?;
    let mean = |p: &[f32; 3]| ((p[0] + p[1] + p[2]) / 3.0).clamp(0.0, 1.0);
    Ok(read.pixels.iter().map(mean).collect())
}

/// The alpha of a picture.
pub fn alpha(file: &Path, size: [usize; 2]) -> Result<Vec<f32>, Failure> {
    let read = picture::alpha(file).map_err(FileError::from)?;
    let Some((found, alpha)) = read else {
        return Err(Failure::Input(format!(
            "{}: it has no alpha; name a mask's file instead",
            file.display()
        )));
    };
    check(file, found, size)?;
    Ok(alpha)
}

fn check(file: &Path, found: [usize; 2], size: [usize; 2]) -> Result<(), Failure> {
    match found == size {
        true => Ok(()),
        false => Err(Failure::Input(format!(
            "{}: {}x{} pixels, its target has {}x{}",
            file.display(),
            found[0],
            found[1],
            size[0],
            size[1]
        ))),
    }
}
