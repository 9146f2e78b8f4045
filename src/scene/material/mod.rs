//! Materials from bsdf elements, each once however many shapes use it.

mod interface;
mod metal;
mod mixed;
mod principled;
mod relief;
mod wrappers;

use super::camera::cannot_stand_inside;
use super::data::{Bsdf, Material, Relief};
use super::error::SceneError;
use super::input::Input;
use super::texture::{REFLECTANCE, Slots, Textures};
use super::xml::{Object, Tree};
use std::collections::HashMap;

/// Materials so far.
#[derive(Default)]
pub(super) struct Materials {
    pub list: Vec<Material>,
    /// By the element that says how light is scattered (which may stand inside a `twosided`): used
    /// in several places it is one set of parameters.
    by_object: HashMap<usize, Bsdf>,
    /// By that element, and whether it is two-sided.
    by_use: HashMap<(usize, bool), usize>,
    /// Pictures that turn normals, by the element that says so.
    reliefs: HashMap<usize, Relief>,
    /// What says how much there is of the parts of a mixture, by its element.
    fractions: HashMap<usize, usize>,
    /// How many mixtures the present element stands in.
    depth: usize,
}

impl Materials {
    /// The material of the bsdf object `index`, listed under the bsdf's id or else under `key` if
    /// it is new.
    pub fn bsdf(
        &mut self,
        input: &mut Input,
        textures: &mut Textures,
        index: usize,
        key: &str,
    ) -> Result<usize, SceneError> {
        let tree = input.tree;
        let object = &tree.objects[index];
        let two_sided = object.plugin == "twosided";
        let (inner, levels) = inner(tree, index)?;
        let key = object.id.as_deref().unwrap_or(key);
        let key = format!("{key}{}", ".brdf_0".repeat(levels.saturating_sub(1)));
        self.inner(input, textures, inner, &key, two_sided)
    }

    /// The same of an element that is no `twosided`, of which both sides are alike if it stands in
    /// one.
    fn inner(
        &mut self,
        input: &mut Input,
        textures: &mut Textures,
        inner: usize,
        key: &str,
        two_sided: bool,
    ) -> Result<usize, SceneError> {
        if let Some(&material) = self.by_use.get(&(inner, two_sided)) {
            return Ok(material);
        }
        let tree = input.tree;
        if wrappers::turns_normals(&tree.objects[inner]) {
            return self.turned(input, textures, inner, key, two_sided);
        }
        // Mitsuba puts what is inside a twosided one level down.
        let level = if two_sided { ".brdf_0" } else { "" };
        let bsdf = match self.by_object.get(&inner) {
            Some(&bsdf) => bsdf,
            None if wrappers::is_mixed(&tree.objects[inner]) => {
                let key = format!("{key}{level}");
                self.mixed(input, textures, inner, &key, two_sided)?
            }
            None => {
                let slots = Slots {
                    input,
                    textures,
                    object: &tree.objects[inner],
                    key: format!("{key}{level}"),
                };
                let bsdf = read(slots)?;
                self.by_object.insert(inner, bsdf);
                bsdf
            }
        };
        self.list.push(Material {
            key: key.to_string(),
            bsdf,
            two_sided,
            relief: None,
        });
        let material = self.list.len() - 1;
        self.by_use.insert((inner, two_sided), material);
        Ok(material)
    }

    /// A bsdf of the scene that no shape uses: it is listed, unless its parameters already are.
    pub fn unused(
        &mut self,
        input: &mut Input,
        textures: &mut Textures,
        index: usize,
        key: &str,
    ) -> Result<(), SceneError> {
        let (inner, _) = inner(input.tree, index)?;
        if !self.by_object.contains_key(&inner) && !self.fractions.contains_key(&inner) {
            self.bsdf(input, textures, index, key)?;
        }
        Ok(())
    }

    /// In place of a bsdf that cannot be read, when parameters are listed: one without any.
    pub fn unknown(&mut self, key: &str) -> usize {
        self.list.push(Material {
            key: key.to_string(),
            bsdf: Bsdf::Null,
            two_sided: false,
            relief: None,
        });
        self.list.len() - 1
    }

    /// The textures of a material and of all that it is made of.
    pub fn textures(&self, material: usize) -> Vec<usize> {
        let nested = self.list[material].bsdf.nested().into_iter();
        let mut textures = self.list[material].textures();
        textures.extend(nested.flat_map(|n| self.textures(n.1)));
        textures
    }

    /// Whether texture coordinates say in which direction a material, or a part of it, is brushed
    /// or turned.
    pub fn has_grain(&self, material: usize) -> bool {
        let material = &self.list[material];
        let nested = material.bsdf.nested().into_iter();
        material.relief.is_some()
            || material.bsdf.has_grain()
            || nested.map(|n| n.1).any(|n| self.has_grain(n))
    }

    /// What Mitsuba gives a shape without a bsdf: grey, or black if it emits.
    pub fn add_default(&mut self, textures: &mut Textures, key: &str, emits: bool) -> usize {
        let value = if emits { [0.0; 3] } else { [0.5; 3] };
        let reflectance = textures.push(super::data::Texture {
            limits: REFLECTANCE.limits,
            ..super::data::Texture::constant(format!("{key}.reflectance"), value)
        });
        self.list.push(Material {
            key: key.to_string(),
            bsdf: Bsdf::Diffuse { reflectance },
            two_sided: false,
            relief: None,
        });
        self.list.len() - 1
    }
}

/// The bsdf object itself, or the one inside a `twosided`, and how many of these stand around it.
/// One in another changes nothing: it is seen from its front on both sides.
fn inner(tree: &Tree, mut index: usize) -> Result<(usize, usize), SceneError> {
    let mut levels = 0;
    while tree.objects[index].plugin == "twosided" {
        index = nested(tree, &tree.objects[index])?;
        levels += 1;
    }
    Ok((index, levels))
}

/// The one bsdf inside a `twosided`.
fn nested(tree: &Tree, object: &Object) -> Result<usize, SceneError> {
    let mut found = None;
    for child in &object.children {
        let inner = &tree.objects[child.object];
        if inner.tag != "bsdf" {
            return Err(cannot_stand_inside(child, inner, object));
        }
        wrappers::refuse_transmission(inner, child)?;
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

/// Any bsdf but `twosided`, and but mixtures.
fn read(mut slots: Slots) -> Result<Bsdf, SceneError> {
    match slots.object.plugin.as_str() {
        "conductor" | "roughconductor" => metal::conductor(slots),
        "dielectric" | "roughdielectric" => interface::dielectric(slots),
        "plastic" | "roughplastic" => interface::plastic(slots),
        "thindielectric" => interface::thin_dielectric(slots),
        "principled" => principled::principled(slots),
        "null" => slots.only(&[]).map(|()| Bsdf::Null),
        _ => {
            slots.only(&["reflectance"])?;
            let reflectance = slots.texture("reflectance", [0.5; 3], REFLECTANCE)?;
            Ok(Bsdf::Diffuse { reflectance })
        }
    }
}
