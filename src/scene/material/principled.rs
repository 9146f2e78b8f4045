//! `principled`: Burley's layers.

use crate::scene::data::{Bsdf, Principled};
use crate::scene::error::SceneError;
use crate::scene::texture::{AMOUNT, FRACTION, REFLECTANCE, RELATIVE_IOR, SPECULAR, Slots};
use crate::scene::xml::Object;

/// What takes a texture.
const TEXTURED: [&str; 11] = [
    "base_color",
    "roughness",
    "anisotropic",
    "metallic",
    "spec_trans",
    "spec_tint",
    "sheen",
    "sheen_tint",
    "flatness",
    "clearcoat",
    "clearcoat_gloss",
];
/// Mitsuba's defaults.
const ROUGHNESS: f64 = 0.5;
const BASE_COLOR: f64 = 0.5;
const DEFAULT_SPECULAR: f64 = 0.5;
/// What Mitsuba makes of an interface that light would not notice, where it lets light through.
const LEAST_SPECULAR: f64 = 1e-3;
const LEAST_ETA: f64 = 1.001;

/// Whether it lets light through.
pub(super) fn transmits(object: &Object) -> Result<bool, SceneError> {
    has(object, "spec_trans")
}

/// Whether it has a layer: as in Mitsuba, if anything but a zero is given.
fn has(object: &Object, name: &str) -> Result<bool, SceneError> {
    if object.children.iter().any(|c| c.name == name) {
        return Ok(true);
    }
    Ok(object.number(name)?.is_some_and(|s| s != 0.0))
}

pub(super) fn principled(mut slots: Slots) -> Result<Bsdf, SceneError> {
    slots.only(&TEXTURED)?;
    let object = slots.object;
    for rate in [
        "main_specular_sampling_rate",
        "clearcoat_sampling_rate",
        "diffuse_reflectance_sampling_rate",
    ] {
        // How Mitsuba draws samples, which does not change the image.
        object.float(rate)?;
    }
    let transmits = transmits(object)?;
    let is_brushed = has(object, "anisotropic")?;
    let (eta, by_specular) = eta(&mut slots, transmits)?;
    let mut of = |name, default, kind| slots.texture(name, [default; 3], kind);
    Ok(Bsdf::Principled(Principled {
        base_color: of("base_color", BASE_COLOR, REFLECTANCE)?,
        roughness: of("roughness", ROUGHNESS, FRACTION)?,
        anisotropic: of("anisotropic", 0.0, FRACTION)?,
        metallic: of("metallic", 0.0, FRACTION)?,
        spec_trans: of("spec_trans", 0.0, FRACTION)?,
        is_brushed,
        transmits,
        eta,
        by_specular,
        spec_tint: of("spec_tint", 0.0, FRACTION)?,
        sheen: of("sheen", 0.0, AMOUNT)?,
        sheen_tint: of("sheen_tint", 0.0, FRACTION)?,
        flatness: of("flatness", 0.0, FRACTION)?,
        clearcoat: of("clearcoat", 0.0, AMOUNT)?,
        clearcoat_gloss: of("clearcoat_gloss", 0.0, FRACTION)?,
    }))
}

/// The slot of the index of refraction, and whether it holds a `specular`.
fn eta(slots: &mut Slots, transmits: bool) -> Result<(usize, bool), SceneError> {
    let object = slots.object;
    if object.has("eta") {
        if object.has("specular") {
            let what =
                "\"specular\" cannot be given together with \"eta\": each follows from the other";
            return Err(object.property_error("specular", what));
        }
        let mut eta = object.positive("eta", 1.0)?;
        if transmits && eta == 1.0 {
            eta = LEAST_ETA;
        }
        let [low, high] = RELATIVE_IOR.limits;
        if !(low..=high).contains(&(eta as f32)) {
            let what = format!("\"eta\" must be between {low} and {high}, not {eta}");
            return Err(object.property_error("eta", what));
        }
        return Ok((slots.constant("eta", [eta as f32; 3], RELATIVE_IOR), false));
    }
    let mut specular = object.float("specular")?.unwrap_or(DEFAULT_SPECULAR);
    let [low, high] = SPECULAR.limits;
    if !(low..=high).contains(&(specular as f32)) {
        let what = format!("\"specular\" must be between {low} and {high}, not {specular}");
        return Err(object.property_error("specular", what));
    }
    if transmits && specular == 0.0 {
        specular = LEAST_SPECULAR;
    }
    Ok((
        slots.constant("specular", [specular as f32; 3], SPECULAR),
        true,
    ))
}
