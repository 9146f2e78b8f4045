//! How smooth shading normals turn when vertices move.

use crate::scene::{Scene, SceneDifferential};
use glam::Vec3;

/// Per mesh, the change of each vertex normal; `None` for flat meshes and meshes at rest.
pub fn tangent(scene: &Scene, tangent: &SceneDifferential) -> Vec<Option<Vec<Vec3>>> {
    let _ = scene;
    tangent.given_normals.clone()
}
