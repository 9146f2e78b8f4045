//! How tightly boxes fit when vertices move: whether a hierarchy is worth refitting.
//!
//! A ray's work in a hierarchy of boxes grows with the sum of their areas over that of the whole.
//! Embree does not show its boxes; those around runs of triangles in Morton order, of 4, 64 and
//! 1024, stand for them. Refitting keeps the runs and moves the boxes: the sum's growth is how much
//! looser a refitted hierarchy is than it was.

use super::MeshView;
use glam::Vec3;

/// Triangles under one box, on each level.
const RUNS: [usize; 3] = [4, 64, 1024];

/// Of each mesh, triangles in Morton order and the sum at the positions this was made at.
pub struct Tightness {
    meshes: Vec<(Vec<u32>, f64)>,
}

impl Tightness {
    /// Looks at meshes as a hierarchy over them was, or would be, built.
    pub fn new(meshes: &[MeshView]) -> Self {
        let of = |mesh: &MeshView| {
            let order = morton_order(mesh);
            let sum = area_sum(mesh, &order);
            (order, sum)
        };
        Self {
            meshes: meshes.iter().map(of).collect(),
        }
    }

    /// The sum now over the sum then, of the loosest of the meshes that `moved`: 1 where boxes fit
    /// as they did.
    pub fn looseness(&self, meshes: &[MeshView], moved: &[bool]) -> f64 {
        let now = self.meshes.iter().zip(meshes).zip(moved);
        now.filter(|(_, moved)| **moved)
            .map(|(((order, then), mesh), _)| match *then > 0.0 {
                true => area_sum(mesh, order) / then,
                false => 1.0,
            })
            .fold(1.0, f64::max)
    }
}

/// The areas of all boxes, relative to that around the mesh.
fn area_sum(mesh: &MeshView, order: &[u32]) -> f64 {
    let whole = bounds(mesh, order);
    let total = half_area(whole);
    if total <= 0.0 {
        return 0.0;
    }
    let level = |run: usize| -> f64 {
        let boxes = order.chunks(run).map(|run| half_area(bounds(mesh, run)));
        boxes.sum()
    };
    RUNS.into_iter().map(level).sum::<f64>() / total
}

fn bounds(mesh: &MeshView, triangles: &[u32]) -> [Vec3; 2] {
    let empty = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    let corners = triangles.iter().flat_map(|&t| mesh.triangles[t as usize]);
    corners.fold(empty, |[low, high], v| {
        let p = mesh.positions[v as usize];
        [low.min(p), high.max(p)]
    })
}

fn half_area([low, high]: [Vec3; 2]) -> f64 {
    let d = (high - low).as_dvec3();
    match d.is_finite() {
        true => d.x * d.y + d.y * d.z + d.z * d.x,
        false => 0.0,
    }
}

fn morton_order(mesh: &MeshView) -> Vec<u32> {
    let mut order: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    let [low, high] = bounds(mesh, &order);
    let scale = (high - low).max(Vec3::splat(f32::MIN_POSITIVE)).recip() * 1023.0;
    order.sort_by_cached_key(|&t| {
        let [a, b, c] = mesh.triangles[t as usize].map(|v| mesh.positions[v as usize]);
        let at = ((a + b + c) / 3.0 - low) * scale;
        let [x, y, z] = at.to_array().map(|v| spread(v as u32));
        (x | y << 1 | z << 2, t)
    });
    order
}

/// Puts two zeros between the ten low bits.
fn spread(x: u32) -> u32 {
    let mut x = x & 0x3ff;
    x = (x | x << 16) & 0x0300_00ff;
    x = (x | x << 8) & 0x0300_f00f;
    x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}
