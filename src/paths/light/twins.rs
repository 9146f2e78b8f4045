//! Which half-edges of a light's mesh run along the same edge.

use crate::trace::geometry::Geometry;
use rayon::slice::ParallelSliceMut;

/// No half-edge.
pub const NONE: u32 = u32::MAX;

/// For each half-edge of a mesh (3·triangle + the corner it is opposite to) the latest one before
/// it that runs the other way between the same positions, or [`NONE`].
pub fn twins(geometry: &Geometry, mesh: usize) -> Vec<u32> {
    let welded = geometry.welded(mesh);
    let v0 = geometry.first_vertex[mesh];
    let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m] as usize);
    let triangles = &geometry.triangles[first..end];
    // Sorted so that the half-edges between two positions stand together, in their order.
    let mut edges: Vec<(u64, u32, bool)> = Vec::with_capacity(3 * triangles.len());
    for (t, triangle) in triangles.iter().enumerate() {
        let v = triangle.map(|v| welded[(v - v0) as usize]);
        for c in 0..3 {
            let (from, to) = (v[(c + 1) % 3], v[(c + 2) % 3]);
            let key = u64::from(from.min(to)) << 32 | u64::from(from.max(to));
            edges.push((key, (3 * t + c) as u32, from < to));
        }
    }
    edges.par_sort_unstable();
    let mut twins = vec![NONE; edges.len()];
    for between in edges.chunk_by(|a, b| a.0 == b.0) {
        let mut latest = [NONE; 2];
        for &(key, half_edge, up) in between {
            // One without a length runs both ways.
            let is_point = key >> 32 == key & u64::from(u32::MAX);
            twins[half_edge as usize] = latest[usize::from(up == is_point)];
            latest[usize::from(up)] = half_edge;
        }
    }
    twins
}
