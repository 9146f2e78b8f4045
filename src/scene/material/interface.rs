//! `dielectric`, `plastic` and their rough kinds: interfaces between two media, smooth or of
//! microfacets.

use crate::scene::data::{Bsdf, Distribution, Microfacets};
use crate::scene::error::SceneError;
use crate::scene::iors::IORS;
use crate::scene::nearest::{known_hint, shown};
use crate::scene::texture::{REFLECTANCE, RELATIVE_IOR, ROUGHNESS, Slots};
use crate::scene::xml::Object;

/// Mitsuba's default roughness.
const ALPHA: f64 = 0.1;
/// The slots of roughness.
pub(super) const ALPHAS: [&str; 3] = ["alpha", "alpha_u", "alpha_v"];

pub(super) fn dielectric(mut slots: Slots) -> Result<Bsdf, SceneError> {
    let is_rough = slots.object.plugin == "roughdielectric";
    let mut names = vec!["specular_reflectance", "specular_transmittance"];
    if is_rough {
        names.extend(ALPHAS);
    }
    slots.only(&names)?;
    Ok(Bsdf::Dielectric {
        eta: eta(&mut slots, "bk7")?,
        specular_reflectance: slots.texture("specular_reflectance", [1.0; 3], REFLECTANCE)?,
        specular_transmittance: slots.texture("specular_transmittance", [1.0; 3], REFLECTANCE)?,
        microfacets: if is_rough {
            Some(microfacets(&mut slots)?)
        } else {
            None
        },
    })
}

/// A pane, without any thickness of its own.
pub(super) fn thin_dielectric(mut slots: Slots) -> Result<Bsdf, SceneError> {
    slots.only(&["specular_reflectance", "specular_transmittance"])?;
    Ok(Bsdf::ThinDielectric {
        eta: eta(&mut slots, "bk7")?,
        specular_reflectance: slots.texture("specular_reflectance", [1.0; 3], REFLECTANCE)?,
        specular_transmittance: slots.texture("specular_transmittance", [1.0; 3], REFLECTANCE)?,
    })
}

pub(super) fn plastic(mut slots: Slots) -> Result<Bsdf, SceneError> {
    let is_rough = slots.object.plugin == "roughplastic";
    if is_rough {
        // As in Mitsuba, which takes colours for the other roughnesses.
        slots.object.float("alpha")?;
    }
    let named_alpha = |c: &&crate::scene::xml::Child| is_rough && c.name == "alpha";
    if let Some(child) = slots.object.children.iter().find(named_alpha) {
        // Mitsuba tabulates transmission for one roughness.
        let what = "the \"alpha\" of a roughplastic must be a number, not a texture";
        return Err(SceneError::at(&child.place, what));
    }
    slots.only(&["diffuse_reflectance", "specular_reflectance"])?;
    Ok(Bsdf::Plastic {
        eta: eta(&mut slots, "polypropylene")?,
        diffuse_reflectance: slots.texture("diffuse_reflectance", [0.5; 3], REFLECTANCE)?,
        specular_reflectance: slots.texture("specular_reflectance", [1.0; 3], REFLECTANCE)?,
        nonlinear: slots.object.boolean("nonlinear", false)?,
        microfacets: if is_rough {
            Some(microfacets(&mut slots)?)
        } else {
            None
        },
    })
}

/// The index inside over the index outside.
fn eta(slots: &mut Slots, inside: &str) -> Result<usize, SceneError> {
    let object = slots.object;
    let (inside, outside) = (
        ior(object, "int_ior", inside)?,
        ior(object, "ext_ior", "air")?,
    );
    let eta = (inside / outside) as f32;
    let [low, high] = RELATIVE_IOR.limits;
    if !(low..=high).contains(&eta) {
        let what =
            format!("int_ior / ext_ior must be between {low} and {high}, not {inside} / {outside}");
        return Err(object.property_error("int_ior", what));
    }
    if inside == outside && object.plugin.starts_with("rough") {
        let what = "a rough interface needs an int_ior that differs from ext_ior";
        return Err(object.property_error("int_ior", what));
    }
    Ok(slots.constant("eta", [eta; 3], RELATIVE_IOR))
}

/// An index of refraction by number or by name, of which the case does not count.
fn ior(object: &Object, property: &str, default: &str) -> Result<f64, SceneError> {
    let name = if object.holds_string(property) {
        object.string(property)?.unwrap_or_default()
    } else if object.has(property) {
        return object.positive(property, 1.0);
    } else {
        default.to_string()
    };
    let known = IORS.iter().find(|i| i.0 == name.to_lowercase());
    known.map(|i| f64::from(i.1)).ok_or_else(|| {
        let what = format!(
            "no material \"{}\" is known{}; or give a number, as in <float name=\"{property}\" value=\"1.5\"/>",
            shown(&name),
            known_hint(&name, IORS.iter().map(|i| i.0))
        );
        object.property_error(property, what)
    })
}

/// Distribution and roughness.
pub(super) fn microfacets(slots: &mut Slots) -> Result<Microfacets, SceneError> {
    let object = slots.object;
    let distribution = match object.choice("distribution", "beckmann", &["beckmann", "ggx"])? {
        "beckmann" => Distribution::Beckmann,
        _ => Distribution::Ggx,
    };
    // How Mitsuba draws samples, which does not change the image.
    object.boolean("sample_visible", true)?;
    let is_given = |name: &str| object.has(name) || object.children.iter().any(|c| c.name == name);
    let (has_u, has_v) = (is_given("alpha_u"), is_given("alpha_v"));
    let (alpha, alpha_v) = match (has_u, has_v) {
        (false, false) => (slots.texture("alpha", [ALPHA; 3], ROUGHNESS)?, None),
        (true, true) if is_given("alpha") => {
            let what = "\"alpha\" cannot be given together with \"alpha_u\" and \"alpha_v\"";
            return Err(object.property_error("alpha", what));
        }
        (true, true) if object.plugin == "roughplastic" => (same_alphas(slots)?, None),
        (true, true) => (
            slots.texture("alpha_u", [ALPHA; 3], ROUGHNESS)?,
            Some(slots.texture("alpha_v", [ALPHA; 3], ROUGHNESS)?),
        ),
        (true, false) => {
            let what = "\"alpha_v\" is missing beside it";
            return Err(object.property_error("alpha_u", what));
        }
        (false, true) => {
            let what = "\"alpha_u\" is missing beside it";
            return Err(object.property_error("alpha_v", what));
        }
    };
    Ok(Microfacets {
        distribution,
        alpha,
        alpha_v,
    })
}

/// The roughness of a plastic that is given along u and along v, where it has to be the same.
fn same_alphas(slots: &mut Slots) -> Result<usize, SceneError> {
    let object = slots.object;
    match (object.number("alpha_u")?, object.number("alpha_v")?) {
        (Some(u), Some(v)) if u == v => {
            let [_, high] = ROUGHNESS.limits;
            if !(0.0..=f64::from(high)).contains(&u) {
                let what = format!("\"alpha_u\" must be between 0 and {high}, not {u}");
                return Err(object.property_error("alpha_u", what));
            }
            let alpha = u.max(f64::from(ROUGHNESS.limits[0])) as f32;
            Ok(slots.constant("alpha", [alpha; 3], ROUGHNESS))
        }
        _ => {
            let what = "the roughness of a roughplastic cannot depend on the direction (alpha_u unlike alpha_v); \
                        give \"alpha\"";
            Err(object.property_error("alpha_v", what))
        }
    }
}
