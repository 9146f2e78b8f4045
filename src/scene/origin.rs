//! Where tracing has its origin. Single precision tells places apart by a part of their
//! coordinates, and rays leave surfaces by [`super::RAY_OFFSET`] of them. In a scene that lies far
//! away, as what is placed by its place on Earth, that would be a good part of the scene. So such
//! scenes are traced about their own middle. Nothing that a user gives or gets is: positions, poses
//! and matrices are those of the file, and velocities and gradients do not ask for an origin.

use super::data::Mesh;
use glam::Vec3;

/// How many times its own size a scene may lie away from the origin. What lies nearer gains less
/// than this by a move, and keeps the numbers of its file.
const FAR: f32 = 4.0;

/// The point of the world that is traced as (0, 0, 0): the middle of all meshes, if these lie far
/// away.
pub fn origin(meshes: &[Mesh]) -> Vec3 {
    let positions = || {
        meshes
            .iter()
            .flat_map(|mesh| mesh.positions.iter().copied())
    };
    let Some(low) = positions().reduce(Vec3::min) else {
        return Vec3::ZERO;
    };
    let high = positions().reduce(Vec3::max).unwrap_or(low);
    let [middle, half] = [(low + high) / 2.0, (high - low) / 2.0];
    // Of what is no number nothing is known; it is refused elsewhere.
    let is_far = middle.abs().max_element() > FAR * half.length();
    if is_far && middle.is_finite() {
        middle
    } else {
        Vec3::ZERO
    }
}
