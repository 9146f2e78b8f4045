//! `checkerboard`: two colours.

use super::to_uv::to_uv;
use crate::scene::camera::cannot_stand_inside;
use crate::scene::data::{Layout, Rgb, Texture};
use crate::scene::error::SceneError;
use crate::scene::xml::{Object, Tree};

/// The texture for a slot of `channels`, without limits.
pub(super) fn checkerboard(
    tree: &Tree,
    object: &Object,
    key: String,
    channels: usize,
) -> Result<Texture, SceneError> {
    if let Some(child) = object.children.first() {
        let inner = &tree.objects[child.object];
        if inner.tag == "texture" {
            let what = "the colours of a checkerboard must be constant: textures inside it are not supported";
            return Err(SceneError::at(&child.place, what));
        }
        return Err(cannot_stand_inside(child, inner, object));
    }
    let colour = |name, default: f64| -> Result<Rgb, SceneError> {
        let colour = object.colour(name)?.unwrap_or([default; 3]);
        // As a number, a constant colour is its plain mean.
        let mean = colour.iter().sum::<f64>() / 3.0;
        Ok(match channels {
            1 => [mean as f32; 3],
            _ => colour.map(|c| c as f32),
        })
    };
    let colours = [colour("color0", 0.4)?, colour("color1", 0.2)?];
    let mut texture = Texture {
        layout: Layout::Checkerboard {
            to_uv: to_uv(object)?,
        },
        channels,
        ..Texture::constant(key, [0.0; 3])
    };
    let order = [0, 1].map(|texel| texture.checkerboard_texel(texel));
    texture.texels = order.map(|number| colours[number]).to_vec();
    Ok(texture)
}
