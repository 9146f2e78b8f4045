//! The meshes of a scene where tracing has them.

use crate::scene::Mesh;
use crate::trace::MeshView;
use glam::Vec3;
use std::borrow::Cow;

/// Meshes about another origin than the world's.
pub struct Placed<'a> {
    meshes: &'a [Mesh],
    positions: Vec<Cow<'a, [Vec3]>>,
}

impl<'a> Placed<'a> {
    /// With `origin` at (0, 0, 0).
    pub fn new(meshes: &'a [Mesh], origin: Vec3) -> Self {
        let place = |mesh: &'a Mesh| match origin == Vec3::ZERO {
            true => Cow::Borrowed(&mesh.positions[..]),
            false => mesh.positions.iter().map(|p| *p - origin).collect(),
        };
        Self {
            meshes,
            positions: meshes.iter().map(place).collect(),
        }
    }

    /// As they are traced.
    pub fn views(&self) -> Vec<MeshView<'_>> {
        let placed = self.meshes.iter().zip(&self.positions);
        placed
            .map(|(mesh, positions)| MeshView {
                positions,
                triangles: &mesh.triangles,
            })
            .collect()
    }
}
