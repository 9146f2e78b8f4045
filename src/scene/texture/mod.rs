//! Textures from properties and texture elements, each once however many slots use it.

mod attribute;
mod bitmap;
mod checkerboard;
mod slots;
mod to_uv;

pub(super) use bitmap::picture;
pub(super) use slots::Slots;

use super::data::{Layout, Texture};
use super::error::{Place, SceneError};
use super::input::Input;
use std::collections::HashMap;

/// What a slot takes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind {
    /// 3 for colours, 1 for numbers.
    pub channels: usize,
    pub limits: [f32; 2],
}

/// Fractions of light.
pub(super) const REFLECTANCE: Kind = Kind {
    channels: 3,
    limits: [0.0, 1.0],
};
/// Light.
pub(super) const POSITIVE: Kind = Kind {
    channels: 3,
    limits: [0.0, f32::INFINITY],
};
/// Indices of refraction of metals: squares of squares must fit in single precision.
pub(super) const METAL_INDEX: Kind = Kind {
    channels: 3,
    limits: [0.0, 1e6],
};
/// Parts of a whole.
pub(super) const FRACTION: Kind = Kind {
    channels: 1,
    limits: [0.0, 1.0],
};
/// How much there is of a layer: 1 is what is meant to be the most.
pub(super) const AMOUNT: Kind = Kind {
    channels: 1,
    limits: [0.0, 100.0],
};
/// What stands for an index of refraction: 12.5 would be infinite.
pub(super) const SPECULAR: Kind = Kind {
    channels: 1,
    limits: [0.0, 10.0],
};
/// Directions as colours.
pub(super) const NORMALS: Kind = Kind {
    channels: 3,
    limits: [0.0, 1.0],
};
/// Heights.
pub(super) const HEIGHT: Kind = Kind {
    channels: 1,
    limits: [f32::NEG_INFINITY, f32::INFINITY],
};
/// Roughness: Mitsuba raises what is smaller.
pub(super) const ROUGHNESS: Kind = Kind {
    channels: 1,
    limits: [1e-4, 1.0],
};
/// Index inside over index outside: wider than anything that exists.
pub(super) const RELATIVE_IOR: Kind = Kind {
    channels: 1,
    limits: [0.01, 100.0],
};

/// What waits for the mesh that has it.
struct Awaited {
    /// `vertex_color`.
    name: String,
    scale: f32,
    place: Place,
}

/// Textures so far.
#[derive(Default)]
pub(super) struct Textures {
    pub list: Vec<Texture>,
    /// Of what was taken as it is, though it should be otherwise.
    pub remarks: Vec<String>,
    /// By the texture element that they come from.
    by_object: HashMap<usize, usize>,
    /// Those that wait for an attribute of a mesh.
    waiting: HashMap<usize, Awaited>,
}

impl Textures {
    /// The index of a new texture.
    pub fn push(&mut self, texture: Texture) -> usize {
        self.list.push(texture);
        self.list.len() - 1
    }

    /// The texture element `index` in the slot `key`, which was asked for at `place`. It is listed
    /// under its own id if it stands in the scene, else as the first slot that uses it.
    pub fn of(
        &mut self,
        input: &mut Input,
        index: usize,
        key: &str,
        kind: Kind,
        place: &Place,
    ) -> Result<usize, SceneError> {
        if let Some(&known) = self.by_object.get(&index) {
            let mut bright = self.list[known].clone();
            bright.limits = kind.limits;
            self.take_bright(&mut bright, place);
            let texture = &mut self.list[known];
            if texture.channels != kind.channels {
                let what =
                    "this texture is used both as a colour and as a number; write it out twice";
                return Err(SceneError::at(place, what));
            }
            texture.limits = [
                texture.limits[0].max(kind.limits[0]),
                texture.limits[1].min(bright.limits[1]),
            ];
            check(texture, place)?;
            return Ok(known);
        }
        let tree = input.tree;
        let object = &tree.objects[index];
        let key = input.scene_id(index).unwrap_or(key).to_string();
        if object.plugin == "mesh_attribute" {
            let texture = self.attribute(tree, object, key, kind)?;
            self.by_object.insert(index, texture);
            return Ok(texture);
        }
        let mut texture = match object.plugin.as_str() {
            "checkerboard" => checkerboard::checkerboard(tree, object, key, kind.channels)?,
            _ => bitmap::bitmap(input, object, key, kind.channels)?,
        };
        texture.limits = kind.limits;
        if kind.channels == 1 {
            raise(&mut texture);
        }
        self.take_bright(&mut texture, place);
        check(&texture, place)?;
        let texture = self.push(texture);
        self.by_object.insert(index, texture);
        Ok(texture)
    }

    /// Pictures of reflectances may exceed one, as Mitsuba lets them.
    fn take_bright(&mut self, texture: &mut Texture, place: &Place) {
        if !matches!(texture.layout, Layout::Bitmap { .. }) || texture.limits != REFLECTANCE.limits
        {
            return;
        }
        let all = texture.texels.iter().flatten().copied();
        let brightest = all.fold(0.0, f32::max);
        if brightest > texture.limits[1] && brightest.is_finite() {
            texture.limits[1] = brightest;
            self.remarks.push(format!(
                "{place}: the picture has reflectances up to {brightest}: surfaces reflect more light than they get"
            ));
        }
    }

    /// A texture element of the scene that no slot uses: it is listed, and its errors are found.
    pub fn unused(&mut self, input: &mut Input, index: usize, key: &str) -> Result<(), SceneError> {
        if self.by_object.contains_key(&index) {
            return Ok(());
        }
        let place = &input.tree.objects[index].place;
        self.of(input, index, key, POSITIVE, place).map(|_| ())
    }
}

/// Lifts what is at least zero to the lower limit.
fn raise(texture: &mut Texture) {
    for number in texture.texels.iter_mut().flatten() {
        if (0.0..texture.limits[0]).contains(number) {
            *number = texture.limits[0];
        }
    }
}

/// Refuses values outside the limits.
fn check(texture: &Texture, place: &Place) -> Result<(), SceneError> {
    let [low, high] = texture.limits;
    let bad = texture.texels.iter().enumerate().find_map(|(i, texel)| {
        let outside = texel.iter().find(|v| !(low..=high).contains(*v));
        outside.map(|v| (i, *v))
    });
    let Some((texel, value)) = bad else {
        return Ok(());
    };
    let at = match texture.layout {
        Layout::Vertices => format!("vertex {texel} has"),
        Layout::Faces => format!("face {texel} has"),
        Layout::Bitmap { width, .. } => format!(
            "column {}, row {} of the picture is",
            texel % width as usize,
            texel / width as usize
        ),
        _ => "it has".to_string(),
    };
    let what = format!(
        "values of this texture must be {}; {at} {value}",
        range(texture.limits)
    );
    Err(SceneError::at(place, what))
}

/// What may be given: numbers that are raised may start at zero.
fn given_limits(kind: Kind) -> String {
    let low = if kind.channels == 1 {
        0.0
    } else {
        kind.limits[0]
    };
    range([low, kind.limits[1]])
}

/// `between 0 and 1`, `at least 0`.
fn range([low, high]: [f32; 2]) -> String {
    if high == f32::INFINITY {
        format!("at least {low}")
    } else {
        format!("between {low} and {high}")
    }
}
