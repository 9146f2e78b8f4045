//! The alpha of a picture, which [`super::read`] drops.

use super::error::{self, PictureError};
use super::format::Format;
use std::io::Cursor;
use std::path::Path;

/// Most bytes that decoding a PNG may take.
const MOST_BYTES: u64 = 4 << 30;

/// Width and height, and one number a pixel from 0 to 1, row by row.
pub type Alpha = ([usize; 2], Vec<f32>);

/// The alpha of a PNG or an OpenEXR file; none if there is no such channel or another format.
///
/// # Errors
///
/// If the file is not there, or is broken.
pub fn alpha(file: &Path) -> Result<Option<Alpha>, PictureError> {
    let bytes = error::read_file(file)?;
    match Format::of(&bytes) {
        Some(Format::Png) => png(&bytes, file),
        Some(Format::Exr) => exr(&bytes, file),
        _ => Ok(None),
    }
}

fn png(bytes: &[u8], file: &Path) -> Result<Option<Alpha>, PictureError> {
    let mut reader = image::ImageReader::with_format(Cursor::new(bytes), image::ImageFormat::Png);
    let mut limits = image::Limits::default();
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let decoded = reader
        .decode()
        .map_err(|error| PictureError::contents(file, error.to_string()))?;
    if !decoded.color().has_alpha() {
        return Ok(None);
    }
    let size = [decoded.width() as usize, decoded.height() as usize];
    let alpha = decoded.to_rgba32f().pixels().map(|p| p.0[3]).collect();
    Ok(Some((size, alpha)))
}

fn exr(bytes: &[u8], file: &Path) -> Result<Option<Alpha>, PictureError> {
    use exr::prelude::*;
    let read = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| PictureError::contents(file, error.to_string()))?;
    let layer = read.layer_data;
    let size = [layer.size.x(), layer.size.y()];
    let channels = layer.channel_data.list.iter();
    let found = channels
        .into_iter()
        .find(|c| c.name.eq_case_insensitive("a"));
    Ok(found.map(|channel| {
        let values = channel.sample_data.values_as_f32();
        (size, values.map(|v| v.clamp(0.0, 1.0)).collect())
    }))
}
