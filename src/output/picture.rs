//! A user's picture, whatever its format.

use super::{FileError, exr, npy};
use crate::methods::Image;
use crate::picture::{self, Colours, Picture, PictureError};
use std::path::Path;

/// Reads a linear RGB image from `.npy` (H×W×3, H×W×1 or H×W), `.exr`, or any format of textures. Every number must be
/// finite.
pub fn read(path: &Path) -> Result<Image, FileError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let image = match extension.as_deref() {
        Some("exr") => exr::read(path)?,
        Some("npy") => {
            from_array(npy::read(path)?).map_err(|what| FileError::contents(path, what))?
        }
        _ => from_picture(picture::read(path, Colours::Auto)?),
    };
    match image
        .pixels
        .iter()
        .position(|pixel| pixel.iter().any(|v| !v.is_finite()))
    {
        None => Ok(image),
        Some(at) => {
            let (x, y) = (at % image.width, at / image.width);
            Err(FileError::contents(
                path,
                format_args!("the pixel at x {x}, y {y} is not finite"),
            ))
        }
    }
}

fn from_picture(picture: Picture) -> Image {
    Image {
        width: picture.width as usize,
        height: picture.height as usize,
        pixels: picture.pixels,
    }
}

impl From<PictureError> for FileError {
    fn from(error: PictureError) -> Self {
        match error {
            PictureError::Contents { file, what } => FileError::contents(file, what),
            PictureError::Io { file, source } => FileError::io(file, source),
        }
    }
}

fn from_array(array: npy::Array) -> Result<Image, String> {
    let values = &array.values;
    let (height, width, pixels) = match array.shape[..] {
        [h, w, 3] => (h, w, values.as_chunks::<3>().0.to_vec()),
        [h, w] | [h, w, 1] => (h, w, values.iter().map(|&v| [v; 3]).collect()),
        _ => {
            return Err(format!(
                "its shape {} is not that of an image, (height, width, 3)",
                npy::tuple(&array.shape)
            ));
        }
    };
    Ok(Image {
        width,
        height,
        pixels,
    })
}
