//! What cannot be differentiated is refused, in words.

use super::error::EngineError;
use super::estimators::{Discontinuity, Method};
use crate::scene::{Bsdf, Scene, SceneDifferential};

/// Refuses gradients that would be silently wrong: discontinuities that the method does not find.
pub fn check(
    scene: &Scene,
    request: &SceneDifferential,
    method: Method,
) -> Result<(), EngineError> {
    let refuse = |what: String| Err(EngineError::Refused(what));
    if let (Some(environment), true) = (&scene.environment, request.environment.is_some())
        && environment.map.is_some_and(|map| map.scale == 0.0)
    {
        return refuse(format!(
            "{}: a map whose scale is 0 is not sampled, so its scale and rotation have no gradient; give it a small scale",
            environment.key
        ));
    }
    let misses = |kind| method.misses(kind);
    if misses(Discontinuity::SharpShadow)
        && let Some(i) = request.delta_lights.iter().position(Option::is_some)
    {
        return refuse(sharp_shadows(&scene.delta_lights[i].key));
    }
    let light_moves = request.delta_lights.iter().any(Option::is_some);
    if !request.moves_geometry() && !request.refraction_moves(scene) && !light_moves {
        return Ok(());
    }
    let used = || {
        let used = scene.meshes.iter().map(|m| m.material);
        used.map(|m| &scene.materials[m])
    };
    for material in used() {
        let key = &material.key;
        match material.bsdf {
            Bsdf::Null if misses(Discontinuity::BehindNull) => {
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
            } if misses(Discontinuity::Mirrored) => {
                return refuse(format!(
                    "{key}: edges seen in perfectly smooth reflections and refractions are not found, so gradients by what \
                     moves would be wrong; use its rough variant with an alpha such as 0.01"
                ));
            }
            _ => {}
        }
    }
    if misses(Discontinuity::SharpShadow)
        && let Some(light) = scene.delta_lights.first()
    {
        return refuse(sharp_shadows(&light.key));
    }
    Ok(())
}

fn sharp_shadows(light: &str) -> String {
    format!(
        "{light}: the shadows of delta lights have sharp edges that are not found, so gradients by what moves \
         would be wrong; use a small area light"
    )
}

/// Whether a reflectance is black somewhere and its gradient is asked for: paths have to go on from
/// black surfaces then.
pub fn asks_about_black(scene: &Scene, request: &SceneDifferential) -> bool {
    scene.materials.iter().any(|m| {
        m.bsdf.textures().into_iter().any(|t| {
            let is_black = |texel: &[f32; 3]| texel.contains(&0.0);
            request.texels[t].is_some() && scene.textures[t].texels.iter().any(is_black)
        })
    })
}
