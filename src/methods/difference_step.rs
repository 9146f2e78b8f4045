//! How far finite differences step.

use super::error::EngineError;
use super::settings::Settings;
use crate::paths::film::camera::Camera;
use crate::scene::parameters::{Parameter, tangent};
use crate::scene::{DeltaLightKind, Layout, Relief, Scene, SceneDifferential};

/// Pixels that the fastest point moves at the step h.
const STEP_PIXELS: f64 = 0.1;
/// Step for parameters that move nothing: the image is linear or smooth in them.
const STEP_COLOUR: f64 = 0.01;
/// And no more than this part of the way to the nearest limit, whatever else moves.
const STEP_ROOM: f64 = 0.2;

/// A step along the direction that moves the fastest point by a tenth of a pixel: of what is seen,
/// or of lights without an extent and of the sky as they would be seen. It is shorter where colours
/// or roughnesses that change as well would come near their limits.
pub fn step(
    scene: &Scene,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
) -> Result<f64, EngineError> {
    let tangent = tangent(scene, direction, settings.sensor)
        .map_err(|e| EngineError::Refused(e.to_string()))?;
    let camera = Camera::new(&scene.sensors[settings.sensor]);
    let width = settings
        .resolution
        .map_or(scene.sensors[settings.sensor].film.width, |r| r[0]) as f64;
    // Of a parallel projection: pixels per unit of length, along the axis that has more of them.
    let [right, down] = camera.direction_per_pixel().map(|d| d.length());
    let per_length = camera
        .parallel_half_width()
        .map(|half| width / (2.0 * half) * (right / down).max(1.0));
    // Pixels per radian.
    let pixels = match per_length {
        None => width / (2.0 * camera.tan_half_x_fov),
        Some(_) => width,
    };
    let per_length_at = |distance: f64| per_length.unwrap_or(pixels / distance.max(1e-6));
    let mut fastest: f64 = 0.0;
    for (mesh, velocities) in scene.meshes.iter().zip(&tangent.positions) {
        let Some(velocities) = velocities else {
            continue;
        };
        for (p, v) in mesh.positions.iter().zip(velocities) {
            let distance = (*p - camera.origin).length() as f64;
            fastest = fastest.max(v.length() as f64 * per_length_at(distance));
        }
    }
    for (light, velocity) in scene.delta_lights.iter().zip(&tangent.delta_lights) {
        if let (DeltaLightKind::Point { position }, Some(v)) = (&light.kind, velocity) {
            let distance = (*position - camera.origin).length() as f64;
            fastest = fastest.max(v.length() as f64 * per_length_at(distance));
        }
    }
    if let Some(motion) = &tangent.environment {
        fastest = fastest.max(motion.rotation.length() as f64 * pixels);
    }
    if let Some(motion) = &tangent.camera {
        let points = scene.meshes.iter().flat_map(|m| &m.positions);
        let depths = points.map(|p| (*p - camera.origin).dot(camera.axes[2]));
        let seen = depths.filter(|depth| *depth > camera.near_clip);
        let [nearest, farthest] = seen.fold([f32::INFINITY, 0.0], |[low, high], depth| {
            [low.min(depth), high.max(depth)]
        });
        let by_translation = motion.translation.length() as f64 * per_length_at(nearest.into());
        let by_turn = motion.rotation.length() as f64 + (motion.x_fov_deg as f64).to_radians();
        let leans = motion.axes.iter().map(|a| a.length() as f64).sum::<f64>();
        // What is far is moved by as much, and the film itself by half its width.
        let per_turn = per_length.map(|p| p * f64::from(farthest) + 0.5 * width);
        let by_turn = (by_turn + leans) * per_turn.unwrap_or(pixels);
        let by_shift = motion.principal_point_offset.length() as f64 * width;
        fastest = fastest.max(by_translation + by_turn + by_shift);
    }
    fastest = fastest.max(fastest_in_reliefs(scene, &tangent) * pixels);
    let step = match fastest > 0.0 && fastest.is_finite() {
        true => STEP_PIXELS / fastest,
        false => STEP_COLOUR,
    };
    Ok(step.min(step_within_limits(scene, &tangent)))
}

/// By how much what is seen in smooth surfaces turns at most, in radians or so, as pictures change
/// that turn their normals: a normal by twice what a map changes, and what it reflects by twice
/// that.
fn fastest_in_reliefs(scene: &Scene, tangent: &SceneDifferential) -> f64 {
    let smooth = scene.materials.iter().filter(|m| m.bsdf.is_smooth());
    let reliefs = smooth.filter_map(|m| m.relief);
    let turns = reliefs.map(|Relief { texture, bumps, .. }| {
        let picture = &scene.textures[texture];
        let texels_per_uv = match picture.layout {
            Layout::Bitmap { width, height, .. } => f64::from(width.max(height)),
            _ => 1.0,
        };
        let largest = |numbers: &mut dyn Iterator<Item = f32>| {
            f64::from(numbers.fold(0.0f32, |most, x| most.max(x.abs())))
        };
        let texels = tangent.texels[texture].iter().flatten().flatten().copied();
        let change = largest(&mut { texels });
        let moved = tangent.to_uv[texture].iter().flatten().copied();
        let beside = picture.texels.windows(2);
        let differences = beside.flat_map(|pair| [0, 1, 2].map(|i| pair[1][i] - pair[0][i]));
        let slides = largest(&mut { moved }) * largest(&mut { differences }) * texels_per_uv;
        match bumps {
            None => 4.0 * (change + slides),
            Some(scale) => 2.0 * change * texels_per_uv * f64::from(scale.abs()),
        }
    });
    turns.fold(0.0, f64::max)
}

/// A step along which no number leaves its limits: a roughness of 0.01 cannot change by 0.02.
pub fn step_within_limits(scene: &Scene, tangent: &SceneDifferential) -> f64 {
    let mut step = f64::INFINITY;
    for (texture, changes) in scene.textures.iter().zip(&tangent.texels) {
        let [low, high] = texture.limits;
        let values = texture.texels.iter().flatten();
        for (value, by) in values.zip(changes.iter().flatten().flatten()) {
            let room = (value - low).min(high - value);
            if room > 0.0 && *by != 0.0 {
                step = step.min(STEP_ROOM * f64::from(room / by.abs()));
            }
        }
    }
    step
}
