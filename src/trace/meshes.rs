//! Meshes to be traced.

use super::error::TraceError;
use glam::Vec3;

/// A triangle mesh to be traced; copied when an [`super::Accel`] is built or refitted.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    pub positions: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
}

impl MeshView<'_> {
    /// How many vertices and triangles it has.
    pub(super) fn counts(&self) -> (usize, usize) {
        (self.positions.len(), self.triangles.len())
    }
}

/// Refuses what no library can be trusted with.
pub(super) fn check(meshes: &[MeshView]) -> Result<(), TraceError> {
    for (mesh, view) in meshes.iter().enumerate() {
        for count in [view.positions.len(), view.triangles.len()] {
            if u32::try_from(count).is_err() {
                return Err(TraceError::TooLarge { mesh, count });
            }
        }
        if let Some(vertex) = view.positions.iter().position(|p| !p.is_finite()) {
            return Err(TraceError::NonFinite { mesh, vertex });
        }
        let vertices = view.positions.len();
        for (triangle, corners) in view.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(TraceError::Index {
                    mesh,
                    triangle,
                    vertex,
                    vertices,
                });
            }
        }
    }
    Ok(())
}
