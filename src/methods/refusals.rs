//! What cannot be differentiated is refused, in words.

use super::{EngineError, Method};
use crate::scene::{Bsdf, Scene, SceneDifferential};

/// Refuses gradients that would be silently wrong: sharp edges that no cell finds.
pub fn check(
    scene: &Scene,
    request: &SceneDifferential,
    method: Method,
) -> Result<(), EngineError> {
    let refuse = |what: String| Err(EngineError::Refused(what));
    for material in &scene.materials {
        if let Bsdf::Conductor { eta, k, .. } = material.bsdf {
            let texels = &scene.textures[eta].texels;
            let is_perfect = texels.iter().flatten().any(|&e| e == 0.0);
            if is_perfect && (request.texels[eta].is_some() || request.texels[k].is_some()) {
                return refuse(format!(
                    "{}: a metal whose index of refraction is 0 reflects everything, and its reflectance has no derivative \
                     by eta and k there; give it a material, or eta above 0",
                    material.key
                ));
            }
        }
    }
    // What ignores visibility has nothing to lose by it.
    if method != Method::Reparam {
        return Ok(());
    }
    if let Some(i) = request.delta_lights.iter().position(Option::is_some) {
        return refuse(sharp_shadows(&scene.delta_lights[i].key));
    }
    if !request.moves_geometry() && !request.bends(scene) {
        return Ok(());
    }
    let used = || {
        let used = scene.meshes.iter().map(|m| m.material);
        used.map(|m| &scene.materials[m])
    };
    for material in used() {
        let key = &material.key;
        match material.bsdf {
            Bsdf::Null => {
                return refuse(format!(
                    "{key}: behind a null surface edges are not found, so gradients by what moves would be wrong; \
                     take the surface out"
                ));
            }
            Bsdf::Conductor {
                microfacets: None, ..
            }
            | Bsdf::Dielectric {
                microfacets: None, ..
            }
            | Bsdf::Plastic {
                microfacets: None, ..
            } => {
                return refuse(format!(
                    "{key}: edges seen in perfectly smooth reflections and refractions are not found, so gradients by what \
                     moves would be wrong; use its rough variant with an alpha such as 0.01"
                ));
            }
            _ => {}
        }
    }
    if let Some(light) = scene.delta_lights.first() {
        return refuse(sharp_shadows(&light.key));
    }
    Ok(())
}

fn sharp_shadows(light: &str) -> String {
    format!(
        "{light}: the shadows of lights without an extent have sharp edges that are not found, so gradients by what moves \
         would be wrong; use a small area light"
    )
}

/// Whether a reflectance is black somewhere and its gradient is asked for: paths have to go on from black surfaces then.
pub fn asks_about_black(scene: &Scene, request: &SceneDifferential) -> bool {
    scene.materials.iter().any(|m| {
        m.bsdf.textures().into_iter().any(|t| {
            let is_black = |texel: &[f32; 3]| texel.contains(&0.0);
            request.texels[t].is_some() && scene.textures[t].texels.iter().any(is_black)
        })
    })
}
