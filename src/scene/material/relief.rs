//! `normalmap` and `bumpmap`: pictures that turn the normals of what they stand around.

use super::Materials;
use super::wrappers::{is_mixed, turns_normals};
use crate::scene::data::{Layout, Relief};
use crate::scene::error::SceneError;
use crate::scene::input::Input;
use crate::scene::texture::{HEIGHT, NORMALS, Slots, Textures};

impl Materials {
    /// The material that is the element `index`, both sides of which are alike if it stands in a
    /// `twosided`.
    pub(super) fn turned(
        &mut self,
        input: &mut Input,
        textures: &mut Textures,
        index: usize,
        key: &str,
        two_sided: bool,
    ) -> Result<usize, SceneError> {
        let tree = input.tree;
        let object = &tree.objects[index];
        let level = if two_sided { ".brdf_0" } else { "" };
        let relief = match self.reliefs.get(&index) {
            Some(&known) => known,
            None => read(Slots {
                input,
                textures,
                object,
                key: format!("{key}{level}"),
            })?,
        };
        self.reliefs.insert(index, relief);
        let bsdfs = object.children.iter();
        let mut bsdfs = bsdfs.filter(|c| tree.objects[c.object].tag == "bsdf");
        let (Some(child), None) = (bsdfs.next(), bsdfs.next()) else {
            let what = format!(
                "a {} needs one bsdf inside, whose normals it turns",
                object.plugin
            );
            return Err(object.error(what));
        };
        let inner = &tree.objects[child.object];
        if turns_normals(inner) || is_mixed(inner) || inner.plugin == "null" {
            let what = format!(
                "{} cannot stand inside {}; put the {} inside instead, around what it turns",
                inner.shown(),
                object.shown(),
                object.plugin
            );
            return Err(SceneError::at(&child.place, what));
        }
        let nested_key = format!("{key}{level}.nested_bsdf");
        let nested = self.nested(input, textures, child.object, &nested_key, two_sided)?;
        let mut material = self.list[nested].clone();
        material.key = key.to_string();
        material.relief = Some(Relief {
            is_mirrored: two_sided,
            ..relief
        });
        self.list.push(material);
        let material = self.list.len() - 1;
        self.by_use.insert((index, two_sided), material);
        Ok(material)
    }
}

fn read(mut slots: Slots) -> Result<Relief, SceneError> {
    let object = slots.object;
    for name in ["flip_invalid_normals", "use_shadowing_function"] {
        if !object.boolean(name, true)? {
            let what = format!("\"{name}\" can only be true");
            return Err(object.property_error(name, what));
        }
    }
    if object.plugin == "normalmap" {
        slots.only_beside_bsdfs(&["normalmap"])?;
        if !object.has("normalmap") && object.children.iter().all(|c| c.name != "normalmap") {
            let what = "a normalmap needs a texture named \"normalmap\"";
            return Err(object.error(what));
        }
        return Ok(Relief {
            texture: slots.texture("normalmap", [0.5, 0.5, 1.0], NORMALS)?,
            bumps: None,
            is_mirrored: false,
        });
    }
    let scale = object.float("scale")?.unwrap_or(1.0) as f32;
    let is_picture =
        |c: &&crate::scene::xml::Child| slots.input.tree.objects[c.object].tag == "texture";
    let mut pictures = object.children.iter().filter(is_picture);
    let (Some(child), None) = (pictures.next(), pictures.next()) else {
        return Err(object.error("a bumpmap needs one texture inside, of heights"));
    };
    let key = format!("{}.nested_texture", slots.key);
    let place = &child.place;
    let texture = slots
        .textures
        .of(slots.input, child.object, &key, HEIGHT, place)?;
    if !matches!(
        slots.textures.list[texture].layout,
        Layout::Bitmap { bilinear: true, .. }
    ) {
        let what = "the heights of a bumpmap must be a bitmap with a bilinear filter: others have no slopes";
        return Err(SceneError::at(place, what));
    }
    Ok(Relief {
        texture,
        bumps: Some(scale),
        is_mirrored: false,
    })
}
