//! `bitmap`: a picture over the unit square of texture coordinates.

use super::to_uv::to_uv;
use crate::scene::camera::no_children;
use crate::scene::data::{Layout, Rgb, Texture, Wrap};
use crate::scene::error::SceneError;
use crate::scene::input::Input;
use crate::scene::xml::Object;

/// Luminance of linear sRGB, as Mitsuba weighs it.
const LUMINANCE: Rgb = [0.212_671, 0.715_160, 0.072_169];

/// The texture for a slot of `channels`, without limits, and whether the picture is grey: it has one channel then in any slot.
pub(super) fn bitmap(
    input: &mut Input,
    object: &Object,
    key: String,
    channels: usize,
) -> Result<(Texture, bool), SceneError> {
    no_children(input.tree, object)?;
    let raw = object.boolean("raw", false)?;
    let wrap = match object.choice("wrap_mode", "repeat", &["repeat", "mirror", "clamp"])? {
        "repeat" => Wrap::Repeat,
        "mirror" => Wrap::Mirror,
        _ => Wrap::Clamp,
    };
    let filter = object.choice("filter_type", "bilinear", &["bilinear", "nearest"])?;
    // How Mitsuba keeps the numbers in memory; here they are always single precision.
    object.property("format");
    object.property("accel");
    let to_uv = to_uv(object)?;
    let mut picture = picture(input, object, raw)?;
    let is_grey = picture.channels == 1;
    if channels == 1 && !is_grey {
        for texel in &mut picture.texels {
            let luminance = (0..3).map(|c| LUMINANCE[c] * texel[c]).sum();
            *texel = [luminance; 3];
        }
        picture.channels = 1;
    }
    let texture = Texture {
        texels: picture.texels,
        channels: picture.channels,
        layout: Layout::Bitmap {
            width: picture.width,
            height: picture.height,
            wrap,
            bilinear: filter == "bilinear",
            to_uv,
        },
        ..Texture::constant(key, [0.0; 3])
    };
    Ok((texture, is_grey))
}

/// Pixels row by row from the top.
pub(in crate::scene) struct Picture {
    pub width: u32,
    pub height: u32,
    pub texels: Vec<Rgb>,
    /// 1 if the file is grey, else 3.
    pub channels: usize,
}

/// The picture that the object's `filename` names. Unless `raw`, what a file of 8 or 16 bits holds is decoded from sRGB.
pub(in crate::scene) fn picture(
    input: &mut Input,
    object: &Object,
    _raw: bool,
) -> Result<Picture, SceneError> {
    input.named_file(object, "exr")?;
    Err(object.property_error("filename", "pictures cannot be read yet"))
}
