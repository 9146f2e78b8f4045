//! `conductor` and `roughconductor`.

use super::interface::{ALPHAS, microfacets};
use crate::scene::data::Bsdf;
use crate::scene::error::SceneError;
use crate::scene::metals::METALS;
use crate::scene::nearest::{known_hint, shown};
use crate::scene::texture::{METAL_INDEX, REFLECTANCE, Slots};
use crate::scene::xml::Object;

/// η = 0, k = 1: reflects everything, at every angle.
const MIRROR: [[f32; 3]; 2] = [[0.0; 3], [1.0; 3]];

pub(super) fn conductor(mut slots: Slots) -> Result<Bsdf, SceneError> {
    let is_rough = slots.object.plugin == "roughconductor";
    let mut names = vec!["eta", "k", "specular_reflectance"];
    if is_rough {
        names.extend(ALPHAS);
    }
    slots.only(&names)?;
    let name = slots.object.string("material")?;
    let indices = match name.as_deref() {
        None | Some("none") => None,
        Some(name) => Some(metal(slots.object, name)?),
    };
    let (eta, k) = match indices {
        Some([eta, k]) => {
            refuse_indices(&slots)?;
            (
                slots.constant("eta", eta, METAL_INDEX),
                slots.constant("k", k, METAL_INDEX),
            )
        }
        None => {
            let [eta, k] = MIRROR.map(|index| index.map(f64::from));
            (
                slots.texture("eta", eta, METAL_INDEX)?,
                slots.texture("k", k, METAL_INDEX)?,
            )
        }
    };
    Ok(Bsdf::Conductor {
        eta,
        k,
        specular_reflectance: slots.texture("specular_reflectance", [1.0; 3], REFLECTANCE)?,
        microfacets: if is_rough {
            Some(microfacets(&mut slots)?)
        } else {
            None
        },
    })
}

/// η and k of a metal by its name, of which the case counts.
fn metal(object: &Object, name: &str) -> Result<[[f32; 3]; 2], SceneError> {
    let found = METALS.iter().find(|m| m.0 == name);
    found.map(|m| [m.1, m.2]).ok_or_else(|| {
        let names = METALS.iter().map(|m| m.0).chain(["none"]);
        let what = format!(
            "no material \"{}\" is known{}; or give \"eta\" and \"k\"",
            shown(name),
            known_hint(name, names)
        );
        object.property_error("material", what)
    })
}

/// A named metal brings its own η and k.
fn refuse_indices(slots: &Slots) -> Result<(), SceneError> {
    let object = slots.object;
    for name in ["eta", "k"] {
        let what = format!("\"{name}\" cannot be given together with a \"material\"");
        if object.has(name) {
            return Err(object.property_error(name, what));
        }
        if let Some(child) = object.children.iter().find(|c| c.name == name) {
            return Err(SceneError::at(&child.place, what));
        }
    }
    Ok(())
}
