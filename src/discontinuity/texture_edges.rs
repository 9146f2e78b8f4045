//! Texture edges: where a texture jumps within a triangle, or between two that do not continue each
//! other: in their texture coordinates, or in the attributes of vertices and faces.
//!
//! Seen from o along d, the barycentrics of a triangle's point are as wᵢ = d·(pⱼ × pₖ): linear in d
//! up to their sum. A coordinate g of the picture is Σwᵢgᵢ/Σwᵢ, so g = k is Σwᵢ(gᵢ − k) = 0: on an
//! arc of directions that are linear in s it has one solution, and over all directions it is the
//! plane through o and a straight line on the triangle, as for an edge.

use crate::discontinuity::adjacency::Across;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::{Boundary, plane_through};
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Lines of one coordinate in one cell and one triangle that are looked at: beyond that the picture
/// is a blur.
const MOST_LINES: usize = 4096;

/// What single precision may move a coordinate by.
const ROUNDING: f64 = 1e-7;

/// Squared part of their length by which rounding may part the axes of two triangles of one plane.
const SAME_AXES: f64 = 1e-8;

/// The texture edges that an arc crosses on a triangle between two of its parameters, in order.
/// `points`: its vertices as seen from the arc's origin.
pub fn lines(
    geometry: &Geometry,
    triangle: u32,
    points: [DVec3; 3],
    arc: &Arc,
    [from, to]: [f64; 2],
) -> Vec<(Boundary, f64)> {
    let mut found = Vec::new();
    let Some(pattern) = geometry.pattern(triangle) else {
        return found;
    };
    if pattern.rulings.is_empty() || from >= to {
        return found;
    }
    let corners = geometry.triangles[triangle as usize];
    let uv = corners.map(|v| geometry.uvs[v as usize].as_dvec2().extend(1.0));
    let [p, q, r] = points;
    let weights = [[q, r], [r, p], [p, q]].map(plane_through);
    let ends = [from, to].map(|s| DVec3::from(weights.map(|w| w.dot(arc.direction(s)))));
    for ruling in &pattern.rulings {
        let g = DVec3::from(uv.map(|uv| ruling.dot(uv)));
        let [a, b] = ends.map(|w| snapped(w.dot(g) / w.element_sum()));
        if !(a.is_finite() && b.is_finite()) {
            continue;
        }
        // A line that lies on an edge belongs to the triangle below it, and not to both or neither.
        let (first, last) = (a.min(b).floor() + 1.0, a.max(b).floor());
        let mut k = first;
        for _ in 0..MOST_LINES {
            if k > last {
                break;
            }
            let height = g - k;
            let [low, high] = ends.map(|w| w.dot(height));
            let s = from + (to - from) * low / (low - high);
            if let (true, Some(ends)) = (s.is_finite(), across_triangle(height)) {
                let triangle = corners;
                found.push((Boundary::TextureEdge { triangle, ends }, s.clamp(from, to)));
            }
            k += 1.0;
        }
    }
    found.sort_by(|a, b| a.1.total_cmp(&b.1));
    found
}

/// A coordinate, which is an integer if rounding alone keeps it from being one: spheres and
/// cylinders have edges where pictures of a few squares jump.
fn snapped(coordinate: f64) -> f64 {
    let nearest = coordinate.round();
    if (coordinate - nearest).abs() < ROUNDING {
        nearest
    } else {
        coordinate
    }
}

/// Where the line on which `height`, given at the corners, is zero enters and leaves the triangle:
/// barycentrics of the second and third corner.
fn across_triangle(height: DVec3) -> Option<[[f64; 2]; 2]> {
    const CORNERS: [[f64; 2]; 3] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
    let mut ends = (0..3).filter_map(|i| {
        let j = (i + 1) % 3;
        let (a, b) = (height[i], height[j]);
        ((a >= 0.0) != (b >= 0.0)).then(|| {
            let t = a / (a - b);
            [0, 1].map(|c| CORNERS[i][c] * (1.0 - t) + CORNERS[j][c] * t)
        })
    });
    Some([ends.next()?, ends.next()?])
}

/// Whether pictures jump across the edge that starts at `corner` of a triangle: as their texture
/// coordinates do, or since both sides have vertices, or triangles, with values of their own, or
/// turn normals about axes of their own.
pub fn is_seam(geometry: &Geometry, triangle: u32, corner: usize, across: &Across) -> bool {
    let Some(pattern) = geometry.pattern(triangle) else {
        return false;
    };
    let edge = |triangle: u32, corner: usize| {
        let vertices = geometry.triangles[triangle as usize];
        [vertices[corner], vertices[(corner + 1) % 3]]
    };
    let own = edge(triangle, corner);
    let [c, d] = edge(across.triangle, across.corner);
    let other = if across.flipped { [c, d] } else { [d, c] };
    let uv = |v: u32| geometry.uvs[v as usize];
    pattern.of_faces
        || (pattern.of_vertices && own != other)
        || (pattern.by_uv && own.map(uv) != other.map(uv))
        || (pattern.turns_normals && turns_otherwise(geometry, [triangle, across.triangle]))
}

/// Whether the axes about which pictures turn normals jump across the edge between two triangles.
fn turns_otherwise(geometry: &Geometry, triangles: [u32; 2]) -> bool {
    let [a, b] = triangles.map(|t| by_uv(geometry, t));
    a.into_iter()
        .zip(b)
        .any(|(a, b)| (a - b).length_squared() > SAME_AXES * a.length_squared())
}

/// The derivatives of the position by texture coordinates on a triangle, or along two of its edges
/// where there are none.
fn by_uv(geometry: &Geometry, triangle: u32) -> [DVec3; 2] {
    let corners = geometry.triangles[triangle as usize];
    let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
    let edges = [q - p, r - p];
    let [s, t, u] = corners.map(|v| {
        let uv = geometry.uvs.get(v as usize);
        uv.copied().unwrap_or_default().as_dvec2()
    });
    let [along, across] = [t - s, u - s];
    let area = along.perp_dot(across);
    if area == 0.0 {
        return edges;
    }
    [
        (edges[0] * across.y - edges[1] * along.y) / area,
        (edges[1] * along.x - edges[0] * across.x) / area,
    ]
}
