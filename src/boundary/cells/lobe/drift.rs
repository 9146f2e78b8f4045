//! What directions over lobes drift with (`paths::lobe_drift`), and where they rest.
//!
//! Bounces follow the pieces of metal, glass and plastic, because their light changes along them.
//!
//! Where a surface is full of detail its normal turns by much over its own size. A lobe that turns
//! with the normal sweeps over what it sees, and where it sees such a surface again, as inside of
//! glass, its ray is turned by many times as much: after four reflections inside of a scanned animal
//! by a hundred thousand times. There directions rest in the world, and what the lobe sends along
//! them changes instead. That has a noise in proportion to one over the lobe's width, but once.

use crate::boundary::search_scene::SearchScene;
use crate::paths::lobe_drift::LobeDrift;
use crate::trace::geometry::Geometry;

/// The mean turn of a mesh's normals over half its size from which it is full of detail; a ball's
/// is 1.7.
const DETAIL_RAD: f64 = 3.0;

/// What directions over lobes drift with; `None` if nothing moves or nothing carries them.
pub fn find(scene: &SearchScene) -> Option<LobeDrift> {
    let view = scene.view;
    if !scene.moving.anything() {
        return None;
    }
    let geometry = view.geometry;
    let is_special = |v: u32| {
        let mesh = geometry.first_vertex.partition_point(|&first| first <= v) - 1;
        view.materials.is_special(view.scene.meshes[mesh].material)
    };
    let rests = (0..geometry.smooth.len())
        .map(|mesh| detail_rad(geometry, mesh) > DETAIL_RAD)
        .collect();
    LobeDrift::new(geometry, scene.pieces(), scene.moving, is_special, rests)
}

/// By how much the shading normals of a mesh turn over half the diagonal of its box, in the mean over
/// its surface. Zero without shading normals: what turns then are edges.
fn detail_rad(geometry: &Geometry, mesh: usize) -> f64 {
    if !geometry.smooth[mesh] {
        return 0.0;
    }
    let vertices = geometry.first_vertex[mesh] as usize..geometry.first_vertex[mesh + 1] as usize;
    let all = geometry.positions[vertices].iter();
    let low = all.clone().copied().reduce(|a, b| a.min(b));
    let high = all.copied().reduce(|a, b| a.max(b));
    let (Some(low), Some(high)) = (low, high) else {
        return 0.0;
    };
    let triangles =
        geometry.first_triangle[mesh] as usize..geometry.first_triangle[mesh + 1] as usize;
    let [mut area, mut turn] = [0.0f64; 2];
    for corners in &geometry.triangles[triangles] {
        let p = corners.map(|v| geometry.positions[v as usize].as_dvec3());
        let n = corners.map(|v| geometry.normals[v as usize].as_dvec3());
        let own = (p[1] - p[0]).cross(p[2] - p[0]).length();
        let along = |i: usize| n[i].distance(n[(i + 1) % 3]) / p[i].distance(p[(i + 1) % 3]);
        let per_length = (0..3).map(along).sum::<f64>() / 3.0;
        if per_length.is_finite() {
            area += own;
            turn += own * per_length;
        }
    }
    0.5 * f64::from(low.distance(high)) * turn / area.max(f64::MIN_POSITIVE)
}
