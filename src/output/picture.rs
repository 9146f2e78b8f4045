//! A user's picture, whatever its format.

use super::{FileError, exr, npy};
use crate::methods::Image;
use std::path::Path;

/// Reads a linear RGB image from `.exr`, or from `.npy` (H×W×3, H×W×1 or H×W). Every number must be finite.
pub fn read(path: &Path) -> Result<Image, FileError> {
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_ascii_lowercase());
    let image = match extension.as_deref() {
        Some("exr") => exr::read(path)?,
        Some("npy") => {
            from_array(npy::read(path)?).map_err(|what| FileError::contents(path, what))?
        }
        _ => {
            return Err(FileError::contents(
                path,
                "an image here is an .exr or an .npy file",
            ));
        }
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
