//! What cannot be differentiated is refused, in words.

use super::{EngineError, Method};
use crate::scene::{Bsdf, DeltaLightKind, Scene, SceneDifferential, Sensor};
use glam::Vec3;

/// Refuses gradients that would be silently wrong: sharp edges that no cell finds.
pub fn check(
    scene: &Scene,
    request: &SceneDifferential,
    method: Method,
) -> Result<(), EngineError> {
    let refuse = |what: String| Err(EngineError::Refused(what));
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

/// Squares of squares of lengths must fit in single precision, in whatever unit they are.
const FARTHEST: f32 = 1e9;

/// Refuses what is farther from the origin than rays can be traced.
pub fn check_reach(scene: &Scene, sensor: &Sensor) -> Result<(), EngineError> {
    let is_far = |p: Vec3| !(p.abs().max_element() <= FARTHEST);
    let refuse = |what: &str, p: Vec3| {
        let [x, y, z] = p.to_array();
        Err(EngineError::Refused(format!(
            "{what}: ({x:e}, {y:e}, {z:e}) is too far from the origin: single precision reaches to {FARTHEST:e}; use a larger \
             unit of length"
        )))
    };
    for mesh in &scene.meshes {
        if let Some(&far) = mesh.positions.iter().find(|p| is_far(**p)) {
            return refuse(&mesh.id, far);
        }
    }
    for light in &scene.delta_lights {
        if let DeltaLightKind::Point { position } = light.kind
            && is_far(position)
        {
            return refuse(&light.key, position);
        }
    }
    let origin = Vec3::from(sensor.to_world.translation);
    if is_far(origin) {
        return refuse(&sensor.id, origin);
    }
    Ok(())
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
