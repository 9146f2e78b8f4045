//! Targets and adjoints: pictures of the size of the image.

use super::failure::Failure;
use crate::output::picture::PictureFile;
use crate::picture::Image;
use std::path::Path;

/// Opens a target or an adjoint; one that is not of the size of the image is refused before it is
/// decoded.
pub fn picture(file: &Path, size: [u32; 2]) -> Result<PictureFile, Failure> {
    let picture = PictureFile::open(file)?;
    match picture.size() {
        Some(found) => check_size(file, found, size).map(|()| picture),
        None => Ok(picture),
    }
}

/// Reads a target or an adjoint of the size of the image.
pub fn image(file: &Path, size: [u32; 2]) -> Result<Image, Failure> {
    let image = picture(file, size)?.read()?;
    check_size(file, [image.width as u64, image.height as u64], size)?;
    Ok(image)
}

fn check_size(file: &Path, found: [u64; 2], wanted: [u32; 2]) -> Result<(), Failure> {
    if found == wanted.map(u64::from) {
        return Ok(());
    }
    let ([found_width, found_height], [width, height]) = (found, wanted);
    Err(Failure::Input(format!(
        "{}: {found_width}x{found_height} pixels, the image rendered has {width}x{height}; give another picture or \
         resolution",
        file.display(),
    )))
}
