//! Every other format, by OpenImageIO: TIFF, tiled and mip-mapped textures, and what else it knows.

use super::error::Fault;
use super::ffi::Open;
use super::size::texels;
use super::{Colours, Encoding, Picture, PictureError, format, srgb_to_linear};
use crate::room;
use std::path::Path;

/// Reads a picture of any format that OpenImageIO knows: the first image of the file, of mip maps
/// the largest. Integers are sRGB-encoded unless the file says that they are linear.
///
/// # Errors
///
/// Those of [`super::read`], with OpenImageIO's own words about broken files.
pub fn read(file: &Path, colours: Colours) -> Result<Picture, PictureError> {
    decode(file, colours)
        .and_then(Picture::all_finite)
        .map_err(|fault| fault.of(file))
}

fn decode(file: &Path, colours: Colours) -> Result<Picture, Fault> {
    let says = |what| format!("{}; OpenImageIO says: {what}", format::unknown(file));
    let mut open = Open::new(file).map_err(says)?;
    let spec = open.spec;
    let count = texels(spec.width.into(), spec.height.into(), usize::MAX)?;
    if spec.channels == 0 {
        return Err(format!(
            "its first channels are neither R, G and B, nor Y, but {}",
            open.other_channels
        )
        .into());
    }
    let samples = open.samples()?;
    let encoding = if spec.is_integer != 0 && spec.is_linear == 0 {
        Encoding::Srgb
    } else {
        Encoding::Linear
    };
    let value = |v| match (encoding, colours) {
        (Encoding::Srgb, Colours::Auto) => srgb_to_linear(v),
        _ => v,
    };
    let mut pixels = room::empty(count)?;
    let texels = samples.chunks_exact(spec.channels as usize);
    pixels.extend(texels.map(|texel| match *texel {
        [r, g, b] => [r, g, b].map(value),
        _ => [value(texel[0]); 3],
    }));
    Ok(Picture {
        width: spec.width,
        height: spec.height,
        pixels,
        encoding,
    })
}
