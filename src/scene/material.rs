//! Materials from bsdf elements, each once however many shapes use it.

use super::camera::{cannot_stand_inside, no_children};
use super::data::{Bsdf, Material, Rgb, Texture};
use super::error::SceneError;
use super::xml::{Object, Tree};
use std::collections::HashMap;

/// Materials so far.
#[derive(Default)]
pub(super) struct Materials {
    pub list: Vec<Material>,
    pub textures: Vec<Texture>,
    /// For each `diffuse` element the material that its colour went into: a colour used in several places is
    /// one parameter.
    by_diffuse: HashMap<usize, usize>,
}

impl Materials {
    /// The material of the bsdf object `index`, listed under the bsdf's id or else under `key` if it is new.
    pub fn bsdf(&mut self, tree: &Tree, index: usize, key: &str) -> Result<usize, SceneError> {
        let object = &tree.objects[index];
        let two_sided = object.plugin == "twosided";
        let diffuse_index = if two_sided {
            nested(tree, object)?
        } else {
            index
        };
        let diffuse = &tree.objects[diffuse_index];
        if let Some(&material) = self.by_diffuse.get(&diffuse_index) {
            if self.list[material].two_sided == two_sided {
                return Ok(material);
            }
            let what = "this bsdf is used both inside a twosided and without: that is not supported yet; \
                        write it out twice";
            return Err(diffuse.error(what));
        }
        let key = object.id.as_deref().unwrap_or(key).to_string();
        // Mitsuba puts what is inside a twosided one level down.
        let level = if two_sided { ".brdf_0" } else { "" };
        let reflectance = Texture {
            limits: [0.0, 1.0],
            ..Texture::constant(
                format!("{key}{level}.reflectance"),
                reflectance(tree, diffuse)?,
            )
        };
        let bsdf = Bsdf::Diffuse {
            reflectance: self.texture(reflectance),
        };
        self.list.push(Material {
            key,
            bsdf,
            two_sided,
        });
        self.by_diffuse.insert(diffuse_index, self.list.len() - 1);
        Ok(self.list.len() - 1)
    }

    /// A bsdf of the scene that no shape uses: it is listed, unless its colour already is.
    pub fn unused(&mut self, tree: &Tree, index: usize, key: &str) -> Result<(), SceneError> {
        let object = &tree.objects[index];
        let diffuse = if object.plugin == "twosided" {
            nested(tree, object)?
        } else {
            index
        };
        if !self.by_diffuse.contains_key(&diffuse) {
            self.bsdf(tree, index, key)?;
        }
        Ok(())
    }

    /// What Mitsuba gives a shape without a bsdf: grey, or black if it emits.
    pub fn add_default(&mut self, key: &str, emits: bool) -> usize {
        let value = if emits { [0.0; 3] } else { [0.5; 3] };
        let reflectance = self.texture(Texture {
            limits: [0.0, 1.0],
            ..Texture::constant(format!("{key}.reflectance"), value)
        });
        self.list.push(Material {
            key: key.to_string(),
            bsdf: Bsdf::Diffuse { reflectance },
            two_sided: false,
        });
        self.list.len() - 1
    }

    /// The index of a new texture.
    pub fn texture(&mut self, texture: Texture) -> usize {
        self.textures.push(texture);
        self.textures.len() - 1
    }
}

/// The one `diffuse` inside a `twosided`.
fn nested(tree: &Tree, object: &Object) -> Result<usize, SceneError> {
    let mut found = None;
    for child in &object.children {
        let inner = &tree.objects[child.object];
        if inner.tag != "bsdf" || inner.plugin == "twosided" {
            return Err(cannot_stand_inside(child, inner, object));
        }
        if found.replace(child.object).is_some() {
            let what =
                "different bsdfs for the two sides are not supported yet; give twosided one bsdf";
            return Err(SceneError::at(&child.place, what));
        }
    }
    found.ok_or_else(|| {
        object.error("twosided needs a bsdf inside, such as <bsdf type=\"diffuse\"/>")
    })
}

fn reflectance(tree: &Tree, diffuse: &Object) -> Result<Rgb, SceneError> {
    no_children(tree, diffuse)?;
    let colour = diffuse.colour("reflectance")?.unwrap_or([0.5; 3]);
    if colour.iter().all(|c| (0.0..=1.0).contains(c)) {
        return Ok(colour.map(|c| c as f32));
    }
    let what = format!("\"reflectance\" must be between 0 and 1, not {colour:?}");
    Err(diffuse.property_error("reflectance", what))
}

/// A radiance, white by default.
pub(super) fn radiance(tree: &Tree, emitter: &Object) -> Result<Rgb, SceneError> {
    no_children(tree, emitter)?;
    if emitter.has("to_world") && emitter.plugin == "area" {
        let what = "an area emitter has no to_world of its own: it goes with its shape";
        return Err(emitter.property_error("to_world", what));
    }
    let colour = emitter.colour("radiance")?.unwrap_or([1.0; 3]);
    if colour.iter().all(|c| *c >= 0.0) {
        return Ok(colour.map(|c| c as f32));
    }
    let what = format!("\"radiance\" must not be negative: {colour:?}");
    Err(emitter.property_error("radiance", what))
}
