//! The slots of a material or light: a constant as a property, or a texture as a child.

use super::{Kind, METAL_INDEX, Textures, given_limits};
use crate::scene::camera::cannot_stand_inside;
use crate::scene::data::Texture;
use crate::scene::error::SceneError;
use crate::scene::input::{Input, given_twice};
use crate::scene::nearest::{known_hint, shown};
use crate::scene::xml::{Child, Object};

/// Reads the slots of one object.
pub(in crate::scene) struct Slots<'r, 'a> {
    pub input: &'r mut Input<'a>,
    pub textures: &'r mut Textures,
    pub object: &'a Object,
    /// What the slots' keys start with, such as `floor.bsdf`.
    pub key: String,
}

impl<'a> Slots<'_, 'a> {
    /// Refuses children that are no textures of the slots `names`.
    pub fn only(&self, names: &[&str]) -> Result<(), SceneError> {
        for child in &self.object.children {
            let inner = &self.input.tree.objects[child.object];
            if inner.tag != "texture" {
                return Err(cannot_stand_inside(child, inner, self.object));
            }
            if !names.contains(&child.name.as_str()) {
                return Err(self.no_such_slot(child, names));
            }
        }
        Ok(())
    }

    /// The same beside bsdfs.
    pub fn only_beside_bsdfs(&self, names: &[&str]) -> Result<(), SceneError> {
        for child in &self.object.children {
            let inner = &self.input.tree.objects[child.object];
            if inner.tag != "bsdf" && !names.contains(&child.name.as_str()) {
                return Err(self.no_such_slot(child, names));
            }
        }
        Ok(())
    }

    fn no_such_slot(&self, child: &Child, names: &[&str]) -> SceneError {
        let what = if child.name.is_empty() {
            format!(
                "the texture says not what it is for; give it a name such as name=\"{}\"",
                names.first().unwrap_or(&"reflectance")
            )
        } else {
            format!(
                "{} takes no texture \"{}\"{}",
                self.object.shown(),
                shown(&child.name),
                known_hint(&child.name, names.iter().copied())
            )
        };
        SceneError::at(&child.place, what)
    }

    /// The texture child of a slot.
    fn child(&self, name: &str) -> Result<Option<&'a Child>, SceneError> {
        let mut all = self.object.children.iter().filter(|c| c.name == name);
        let first = all.next();
        let again = all.next().or(first.filter(|_| self.object.has(name)));
        match again {
            Some(child) => Err(given_twice(&child.place, name)),
            None => Ok(first),
        }
    }

    /// The colour or number `name`.
    pub fn texture(
        &mut self,
        name: &str,
        default: [f64; 3],
        kind: Kind,
    ) -> Result<usize, SceneError> {
        if let Some(child) = self.child(name)? {
            let key = format!("{}.{name}", self.key);
            return self
                .textures
                .of(self.input, child.object, &key, kind, &child.place);
        }
        let value = match kind.channels {
            1 => self.object.number(name)?.map(|v| [v; 3]),
            _ => self.object.colour(name)?,
        };
        let mut value = value.unwrap_or(default).map(|v| v as f32);
        let [low, high] = kind.limits;
        if kind.channels == 1 {
            value = value.map(|v| if v >= 0.0 { v.max(low) } else { v });
        }
        if kind.limits == METAL_INDEX.limits && name == "eta" && value.iter().any(|v| *v < 0.0) {
            // Only its square counts for the reflectance.
            let place = &self.object.place;
            let remark = format!("{place}: \"eta\" is negative, {value:?}: its amount is taken");
            self.textures.remarks.push(remark);
            value = value.map(f32::abs);
        }
        if value.iter().all(|v| (low..=high).contains(v)) {
            return Ok(self.constant(name, value, kind));
        }
        let shown = match value {
            [a, b, c] if a == b && b == c => a.to_string(),
            colour => format!("{colour:?}"),
        };
        let what = format!("\"{name}\" must be {}, not {shown}", given_limits(kind));
        Err(self.object.property_error(name, what))
    }

    /// A slot that holds what follows from other properties.
    pub fn constant(&mut self, name: &str, value: [f32; 3], kind: Kind) -> usize {
        self.textures.push(Texture {
            channels: kind.channels,
            limits: kind.limits,
            ..Texture::constant(format!("{}.{name}", self.key), value)
        })
    }
}
