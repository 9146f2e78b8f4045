//! How near a point of a triangle is to a silhouette: the boundary test of warped-area sampling.

use crate::discontinuity::adjacency::Adjacency;
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};

/// Unit normals of vertices: means of those of the triangles around them, by area, over seams.
pub fn vertex_normals(geometry: &Geometry) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; geometry.positions.len()];
    for mesh in 0..geometry.first_vertex.len() - 1 {
        let first = geometry.first_vertex[mesh];
        let welded = geometry.welded(mesh);
        let of = |v: u32| welded[(v - first) as usize] as usize;
        let triangles = geometry.first_triangle[mesh]..geometry.first_triangle[mesh + 1];
        for t in triangles {
            let corners = geometry.triangles[t as usize];
            let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
            let n = (q - p).cross(r - p);
            corners.into_iter().for_each(|v| sums[of(v)] += n);
        }
        for v in first..geometry.first_vertex[mesh + 1] {
            sums[v as usize] = sums[of(v)];
        }
    }
    sums.iter()
        .map(|n| n.normalize_or_zero().as_vec3())
        .collect()
}

/// 0 on silhouettes that `origin` sees and 1 far from them, over the triangle that is hit at
/// `barycentrics`: the least of two tests.
///
/// By vertices, as published: c²/(β + (1 − β) c²), with c the cosine between a vertex's normal and
/// the view of it, interpolated. It sees far ahead on meshes that are fine and round, and does not
/// vanish on edges.
///
/// By edges: an edge is a silhouette if nothing lies across it, or a triangle of which the other
/// side is seen. The height over each silhouette edge counts, and the distance from a corner that a
/// silhouette merely touches.
pub fn boundary_distance(
    geometry: &Geometry,
    adjacency: &Adjacency,
    (normals, beta): (&[Vec3], f64),
    (triangle, barycentrics): (u32, [f32; 2]),
    origin: DVec3,
) -> f64 {
    let [b1, b2] = barycentrics.map(f64::from);
    let b = [1.0 - b1 - b2, b1, b2];
    let by_vertices = |(v, b): (u32, f64)| {
        let to = (geometry.positions[v as usize].as_dvec3() - origin).normalize_or_zero();
        let cos2 = to.dot(normals[v as usize].as_dvec3()).powi(2);
        b * cos2 / (beta + (1.0 - beta) * cos2)
    };
    let corners = geometry.triangles[triangle as usize];
    let mut distance: f64 = corners.into_iter().zip(b).map(by_vertices).sum();
    for corner in 0..3 {
        if is_silhouette(geometry, adjacency, triangle, corner, origin) {
            // Over the edge from this corner to the next.
            distance = distance.min(b[(corner + 2) % 3]);
        } else if touches(geometry, adjacency, triangle, corner, origin) {
            distance = distance.min(1.0 - b[corner]);
        }
    }
    distance.max(0.0)
}

/// Whether the edge of a triangle that starts at `corner` is a silhouette.
fn is_silhouette(
    geometry: &Geometry,
    adjacency: &Adjacency,
    triangle: u32,
    corner: usize,
    origin: DVec3,
) -> bool {
    match adjacency.across(triangle, corner) {
        None => true,
        Some(across) => {
            let flip = if across.flipped { -1.0 } else { 1.0 };
            let own = side(geometry, triangle, origin);
            own * side(geometry, across.triangle, origin) * flip <= 0.0
        }
    }
}

/// Whether a silhouette runs through a corner of a triangle.
fn touches(
    geometry: &Geometry,
    adjacency: &Adjacency,
    triangle: u32,
    corner: usize,
    origin: DVec3,
) -> bool {
    // Around the corner, from the edge that starts there. Fans are short; a loop that comes back
    // another way ends anyway.
    const MOST: usize = 64;
    let (mut at, mut edge) = (triangle, corner);
    for _ in 0..MOST {
        if is_silhouette(geometry, adjacency, at, edge, origin) {
            return true;
        }
        let Some(across) = adjacency.across(at, edge) else {
            return true;
        };
        // The shared edge starts at the other end there, if both are wound alike.
        let own = if across.flipped {
            across.corner
        } else {
            (across.corner + 1) % 3
        };
        // The triangle's other edge at this corner.
        let other = if across.flipped { (own + 2) % 3 } else { own };
        if across.triangle == triangle {
            return false;
        }
        (at, edge) = (across.triangle, other);
    }
    false
}

/// On which side of a triangle's plane `origin` lies.
fn side(geometry: &Geometry, triangle: u32, origin: DVec3) -> f64 {
    let corners = geometry.triangles[triangle as usize];
    let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
    (q - p).cross(r - p).dot(origin - p)
}
