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
    if let (Some(environment), true) = (&scene.environment, request.environment.is_some())
        && environment.map.is_some_and(|map| map.scale == 0.0)
    {
        return refuse(format!(
            "{}: a map whose scale is 0 is not sampled, so its scale and rotation have no gradient; give it a small scale",
            environment.key
        ));
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

/// Squares of squares of lengths must fit in single precision, in whatever unit they are.
const FARTHEST: f32 = 1e9;
/// Of a principal point, in widths of the film.
const MOST_OFFSET: f32 = 1e3;

/// Refuses meshes that are farther from the origin than rays can be traced: before anything is built over them.
pub fn check_meshes(scene: &Scene) -> Result<(), EngineError> {
    for mesh in &scene.meshes {
        if let Some(&far) = mesh.positions.iter().find(|p| is_far(**p)) {
            return Err(too_far(&mesh.id, far));
        }
    }
    Ok(())
}

/// Refuses lights and a camera that are too far, or a camera whose rays are too oblique.
pub fn check_view(scene: &Scene, sensor: &Sensor) -> Result<(), EngineError> {
    for light in &scene.delta_lights {
        if let DeltaLightKind::Point { position } = light.kind
            && is_far(position)
        {
            return Err(too_far(&light.key, position));
        }
    }
    let origin = Vec3::from(sensor.to_world.translation);
    if is_far(origin) {
        return Err(too_far(&sensor.id, origin));
    }
    let offset = sensor.principal_point_offset;
    if !offset.is_finite() || offset.abs().max_element() > MOST_OFFSET {
        return Err(EngineError::Refused(format!(
            "{}: the principal point is {} and {} films away from the middle; at most {MOST_OFFSET} are supported",
            sensor.id, offset.x, offset.y
        )));
    }
    Ok(())
}

fn is_far(p: Vec3) -> bool {
    // What is no number is far, too.
    !p.is_finite() || p.abs().max_element() > FARTHEST
}

fn too_far(what: &str, p: Vec3) -> EngineError {
    let [x, y, z] = p.to_array();
    EngineError::Refused(format!(
        "{what}: ({x:e}, {y:e}, {z:e}) is too far from the origin: single precision reaches to {FARTHEST:e}; use a larger \
         unit of length"
    ))
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
