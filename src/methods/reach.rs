//! How far single precision reaches: what is beyond is refused.

use super::error::EngineError;
use crate::scene::{DeltaLightKind, Scene, Sensor};
use glam::Vec3;

/// Squares of squares of lengths must fit in single precision, in whatever unit they are.
const FARTHEST: f32 = 1e9;
/// Of a principal point, in widths of the film.
const MOST_OFFSET: f32 = 1e3;

/// Refuses meshes that are farther from the origin than rays can be traced: before anything is
/// built over them.
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
