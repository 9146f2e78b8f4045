//! What cannot be differentiated is refused, in words.

use super::error::EngineError;
use super::estimators::{Discontinuity, Method};
use crate::scene::{Scene, SceneDifferential};

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
    if !request.moves_geometry() && !request.refraction_moves(scene) {
        return Ok(());
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
