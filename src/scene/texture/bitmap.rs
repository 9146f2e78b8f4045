//! `bitmap`: a picture over the unit square of texture coordinates.

use super::to_uv::to_uv;
use crate::picture::{Colours, PictureError, decode};
use crate::scene::camera::no_children;
use crate::scene::data::{Layout, Rgb, Texture, Wrap};
use crate::scene::error::SceneError;
use crate::scene::input::Input;
use crate::scene::xml::Object;
use glam::Affine2;

/// Luminance of linear sRGB, as Mitsuba weighs it.
const LUMINANCE: Rgb = [0.212_671, 0.715_160, 0.072_169];

/// The texture for a slot of `channels`, without limits. A slot of one takes the luminance.
pub(super) fn bitmap(
    input: &mut Input,
    object: &Object,
    key: String,
    channels: usize,
) -> Result<Texture, SceneError> {
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
    let mut texture = picture(input, object, key, raw)?;
    if channels == 1 {
        for texel in &mut texture.texels {
            *texel = [luminance(*texel); 3];
        }
        texture.channels = 1;
    }
    if let Layout::Bitmap {
        wrap: w,
        bilinear: b,
        to_uv: t,
        ..
    } = &mut texture.layout
    {
        (*w, *b, *t) = (wrap, filter == "bilinear", to_uv);
    }
    Ok(texture)
}

/// Grey stays as it is, to the bit.
fn luminance(colour: Rgb) -> f32 {
    match colour {
        [r, g, b] if r == g && g == b => r,
        _ => (0..3).map(|c| LUMINANCE[c] * colour[c]).sum(),
    }
}

/// The picture that the object's `filename` names, repeated in both directions and filtered. Unless
/// `raw`, what a file of integers holds is decoded from sRGB.
pub(in crate::scene) fn picture(
    input: &mut Input,
    object: &Object,
    key: String,
    raw: bool,
) -> Result<Texture, SceneError> {
    let file = input.named_file(object, "exr")?;
    let colours = if raw { Colours::Raw } else { Colours::Auto };
    let picture = decode(&file.bytes, &file.path, colours).map_err(|error| match error {
        PictureError::Io { file, source } => SceneError::Io {
            file: file.display().to_string(),
            source,
        },
        wrong => object.property_error("filename", wrong.to_string()),
    })?;
    Ok(Texture {
        texels: picture.pixels,
        layout: Layout::Bitmap {
            width: picture.width,
            height: picture.height,
            wrap: Wrap::Repeat,
            bilinear: true,
            to_uv: Affine2::IDENTITY,
        },
        ..Texture::constant(key, [0.0; 3])
    })
}
