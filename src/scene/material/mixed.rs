//! `mask` and `blendbsdf`: mixtures of other materials, and of nothing.

use super::Materials;
use super::wrappers::refuse_transmission;
use crate::scene::camera::cannot_stand_inside;
use crate::scene::data::Bsdf;
use crate::scene::error::SceneError;
use crate::scene::input::Input;
use crate::scene::texture::{FRACTION, Slots, Textures};
use crate::scene::xml::{Child, Object};

/// Mixtures inside one another.
const DEEPEST: usize = 8;
/// Mitsuba's default opacity.
const OPACITY: f64 = 0.5;

impl Materials {
    /// The mixture that is the element `index`, whose slots and parts are listed under `key`.
    pub(super) fn mixed(
        &mut self,
        input: &mut Input,
        textures: &mut Textures,
        index: usize,
        key: &str,
        two_sided: bool,
    ) -> Result<Bsdf, SceneError> {
        let object = &input.tree.objects[index];
        let is_mask = object.plugin == "mask";
        if self.depth == DEEPEST {
            let what = format!(
                "more than {DEEPEST} masks and blends inside one another are not supported"
            );
            return Err(object.error(what));
        }
        self.depth += 1;
        let slot = if is_mask { "opacity" } else { "weight" };
        let children = inner_bsdfs(input, object)?;
        let fraction = match self.fractions.get(&index) {
            Some(&known) => known,
            None => {
                let is_given = object.has(slot) || object.children.iter().any(|c| c.name == slot);
                if !is_mask && !is_given {
                    let what = "a blendbsdf needs a \"weight\", the part of its second bsdf, such as \
                                <float name=\"weight\" value=\"0.5\"/>";
                    return Err(object.error(what));
                }
                let mut slots = Slots {
                    input,
                    textures,
                    object,
                    key: key.to_string(),
                };
                slots.only_beside_bsdfs(&[slot])?;
                slots.texture(slot, [OPACITY; 3], FRACTION)?
            }
        };
        self.fractions.insert(index, fraction);
        let mut nested = |child: &Child, name: &str| {
            if two_sided {
                refuse_transmission(&input.tree.objects[child.object], child)?;
            }
            let key = format!("{key}.{name}");
            self.nested(input, textures, child.object, &key, two_sided)
        };
        let mixed = match (is_mask, children.as_slice()) {
            (true, [child]) => Ok(Bsdf::Mask {
                opacity: fraction,
                nested: nested(child, "nested_bsdf")?,
            }),
            (false, [a, b]) => Ok(Bsdf::Blend {
                weight: fraction,
                nested: [nested(a, "bsdf_0")?, nested(b, "bsdf_1")?],
            }),
            _ => {
                let what = if is_mask {
                    "a mask needs one bsdf inside, which is what rays meet where it is opaque"
                } else {
                    "a blendbsdf needs two bsdfs inside"
                };
                Err(object.error(what))
            }
        };
        self.depth -= 1;
        mixed
    }

    /// A bsdf inside a mixture or a relief.
    pub(super) fn nested(
        &mut self,
        input: &mut Input,
        textures: &mut Textures,
        index: usize,
        key: &str,
        two_sided: bool,
    ) -> Result<usize, SceneError> {
        let object = &input.tree.objects[index];
        if two_sided && object.plugin != "twosided" {
            let key = object.id.as_deref().unwrap_or(key);
            self.inner(input, textures, index, key, true)
        } else {
            self.bsdf(input, textures, index, key)
        }
    }
}

/// The bsdfs that stand inside one, in their order.
fn inner_bsdfs<'a>(input: &Input, object: &'a Object) -> Result<Vec<&'a Child>, SceneError> {
    let mut found = Vec::new();
    for child in &object.children {
        let inner = &input.tree.objects[child.object];
        match inner.tag {
            "bsdf" => found.push(child),
            "texture" => {}
            _ => return Err(cannot_stand_inside(child, inner, object)),
        }
    }
    Ok(found)
}
