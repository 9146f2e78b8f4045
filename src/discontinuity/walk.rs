//! From a visible point to the silhouette: walking over a mesh, triangle by triangle, along a
//! straight line of the image.
//!
//! Two rays of a bundle share the origin o and have directions d_a, d_b. If one of them hits an
//! occluder and the other misses it, then somewhere between them the occluder's silhouette crosses
//! the arc from d_a to d_b. Loubet et al. follow the point that was hit; a point that is *on* the
//! silhouette moves exactly as the discontinuity does, whatever the motion (a turning screw, a
//! growing sphere), so we walk to it: from the triangle that was hit across the edges that the
//! plane of (o, d_a, d_b) cuts, until the next triangle faces away or there is none. No ray is
//! traced. All arithmetic is in f64: the walk's decisions are made from vertices alone and are the
//! same from both sides of an edge.

use crate::discontinuity::adjacency::{Across, Adjacency};
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Reservoir};
use crate::discontinuity::texture_edges;
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Triangles crossed before a walk is given up. An arc of the image that is longer than that in
/// triangles belongs to a mesh far finer than the sampling.
const MAX_STEPS: usize = 512;

/// A crossing of the arc with a silhouette edge.
#[derive(Clone, Copy, Debug)]
pub struct Fold {
    /// Vertices of the edge, numbered across meshes.
    pub edge: [u32; 2],
    /// Where on the arc: the direction there is parallel to (1−s)·d_a + s·d_b.
    pub s: f64,
    /// Where on the edge, from its first vertex to its second.
    pub along: f64,
    /// The point on the edge.
    pub point: DVec3,
    /// Whether it is an acute edge of a body with shading normals.
    pub is_thin: bool,
}

impl Fold {
    /// Seen from the arc's other end.
    pub fn turned(self) -> Self {
        Self {
            s: 1.0 - self.s,
            ..self
        }
    }
}

/// What a walk from a's hit toward b came to.
#[derive(Clone, Copy, Debug)]
pub enum Walk {
    /// The silhouette was reached before the arc's end.
    Fold(Fold),
    /// The triangle that was asked for was reached: both rays see one connected surface.
    Reached,
    /// The surface continues beyond the limit.
    Continues,
    /// Rounding or a degenerate triangle stopped the walk, or it was too long.
    Lost,
}

/// Walks from `start`, the triangle that the ray along `arc.a` hit, toward `arc.b`, whose ray hit
/// `goal`, up to parameter `limit` (1: all the way). What the radiance may jump at on the way is
/// shown to `ridges`: edges at which the surface or its shading bends, and those of pictures.
pub fn walk(
    geometry: &Geometry,
    adjacency: &Adjacency,
    arc: &Arc,
    ends: [u32; 2],
    limit: f64,
    ridges: &mut Reservoir,
) -> Walk {
    let position = |v: u32| geometry.positions[v as usize].as_dvec3() - arc.origin;
    walk_among(position, geometry, adjacency, arc, ends, limit, ridges)
}

/// The same, if `position` says where a vertex is as seen from the arc's origin. Rays that are
/// parallel to one another meet in no origin, but points across them are directions as good as any:
/// the two coordinates of a point across the rays, and 1.
// Long: one loop over triangles, in the hottest place there is; parted into steps it took a quarter
// more instructions.
#[inline]
pub fn walk_among(
    position: impl Fn(u32) -> DVec3,
    geometry: &Geometry,
    adjacency: &Adjacency,
    arc: &Arc,
    [start, goal]: [u32; 2],
    limit: f64,
    ridges: &mut Reservoir,
) -> Walk {
    let normal = arc.a.cross(arc.b);
    let faces = |[p, q, r]: [DVec3; 3]| p.dot((q - p).cross(r - p)) < 0.0;

    // A walk stays on one mesh.
    let is_smooth = geometry.smooth[geometry.mesh_of_triangle[start as usize] as usize];
    let has_texture_edges = geometry.pattern(start).is_some();
    let mut triangle = start;
    let mut vertices = geometry.triangles[start as usize];
    let mut points = vertices.map(&position);
    let mut side = points.map(|p| normal.dot(p));
    let mut facing = faces(points);
    let mut entered_by = None;
    let mut entered_at = 0.0;
    for _ in 0..MAX_STEPS {
        let mut exit: Option<(usize, f64, f64, DVec3)> = None;
        for corner in 0..3 {
            let next = (corner + 1) % 3;
            if Some(corner) == entered_by || (side[corner] >= 0.0) == (side[next] >= 0.0) {
                continue;
            }
            let along = side[corner] / (side[corner] - side[next]);
            let point = points[corner].lerp(points[next], along);
            // In the first triangle the ray itself passes between the two crossings: the way out is
            // toward b.
            let toward_b = normal.dot(arc.a.cross(point));
            if exit.is_none_or(|(_, best, ..)| toward_b > best) {
                exit = Some((corner, toward_b, along, point));
            }
        }
        let Some((corner, toward_b, along, point)) = exit else {
            return Walk::Lost;
        };
        let s = parameter(toward_b, normal.dot(point.cross(arc.b)));
        if has_texture_edges && ridges.is_open() {
            let part = [entered_at, s.min(limit)];
            for (line, s) in texture_edges::lines(geometry, triangle, points, arc, part) {
                ridges.meet(Crossing::ridge(line, s));
            }
        }
        if s >= limit {
            ridges.settle(limit);
            return Walk::Continues;
        }
        let next = (corner + 1) % 3;
        let fold = Fold {
            edge: [vertices[corner], vertices[next]],
            s,
            along,
            point: point + arc.origin,
            is_thin: false,
        };
        let Some(across) = adjacency.across(triangle, corner) else {
            ridges.settle(s);
            return Walk::Fold(fold);
        };
        // The points of the common edge are known; only the third is new.
        let [first, second, third] = [0, 1, 2].map(|i| (across.corner + i) % 3);
        let [at_first, at_second] = if across.flipped {
            [corner, next]
        } else {
            [next, corner]
        };
        let vertices_across = geometry.triangles[across.triangle as usize];
        let mut points_across = points;
        points_across[first] = points[at_first];
        points_across[second] = points[at_second];
        points_across[third] = position(vertices_across[third]);
        facing ^= across.flipped;
        if faces(points_across) != facing {
            ridges.settle(s);
            let [here, there] = [points, points_across].map(|[p, q, r]| (q - p).cross(r - p));
            let is_acute = (here.dot(there) < 0.0) != across.flipped;
            return Walk::Fold(Fold {
                is_thin: is_smooth && is_acute,
                ..fold
            });
        }
        if ridges.is_open() {
            let ridge = Crossing::ridge(Boundary::Edge(fold.edge), s);
            let bend = bend(points, points_across);
            if (bend > FLAT && !is_smooth)
                || (is_smooth && is_torn(geometry, triangle, corner, &across))
                || (has_texture_edges
                    && texture_edges::is_seam(geometry, triangle, corner, &across))
            {
                ridges.meet(ridge);
            } else if bend > FLAT {
                ridges.meet_facet_edge(ridge, (bend / COARSE).min(1.0));
            }
        }
        if across.triangle == goal {
            if has_texture_edges && ridges.is_open() {
                for (line, s) in texture_edges::lines(geometry, goal, points_across, arc, [s, 1.0])
                {
                    ridges.meet(Crossing::ridge(line, s));
                }
            }
            ridges.settle(f64::INFINITY);
            return Walk::Reached;
        }
        let mut side_across = side;
        side_across[first] = side[at_first];
        side_across[second] = side[at_second];
        side_across[third] = normal.dot(points_across[third]);
        (triangle, vertices, points, side) =
            (across.triangle, vertices_across, points_across, side_across);
        entered_by = Some(across.corner);
        entered_at = s;
    }
    Walk::Lost
}

/// Below this squared sine of their angle two triangles lie in one plane, and their common edge is
/// not looked at.
pub const FLAT: f64 = 1e-10;

/// Above this, a tenth of a radian, all bends of smooth surfaces are looked at; of those below, as
/// many as leave each about as much to bring: the part of a hemisphere that lies between two planes
/// goes as the square of their angle.
const COARSE: f64 = 1e-2;

/// How a surface bends at an edge of two triangles.
pub struct Bend {
    /// Of the angle between their planes; `None` where they lie in one plane.
    pub squared_sine: Option<f64>,
    /// Whether the angle between the triangles themselves is acute.
    pub is_acute: bool,
    /// Unit normals, of one orientation of the surface.
    pub normals: [DVec3; 2],
    /// How often the edge of a smooth surface is looked at.
    pub share: f64,
    /// Whether the two sides have shading normals of their own.
    pub is_torn: bool,
}

/// How the surface bends at the edge that starts at `corner` of a triangle.
pub fn bend_at(geometry: &Geometry, triangle: u32, corner: usize, across: &Across) -> Bend {
    let points = |t: u32| {
        let corners = geometry.triangles[t as usize];
        corners.map(|v| geometry.positions[v as usize].as_dvec3())
    };
    let [here, there] = [points(triangle), points(across.triangle)];
    let sine = bend(here, there);
    let [n, m] = [here, there].map(|[p, q, r]| (q - p).cross(r - p).normalize_or_zero());
    let m = if across.flipped { -m } else { m };
    Bend {
        squared_sine: (sine > FLAT).then_some(sine),
        is_acute: n.dot(m) < 0.0,
        normals: [n, m],
        share: (sine / COARSE).min(1.0),
        is_torn: is_torn(geometry, triangle, corner, across),
    }
}

/// The squared sine of the angle between the planes of two triangles.
pub(super) fn bend(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
    let [na, nb] = [a, b].map(|[p, q, r]| (q - p).cross(r - p));
    na.cross(nb).length_squared() / (na.length_squared() * nb.length_squared())
}

/// Whether the shading normals on the two sides of an edge differ, whose vertices each side has for
/// itself: so programs write bodies with hard edges.
pub fn is_torn(geometry: &Geometry, triangle: u32, corner: usize, across: &Across) -> bool {
    if geometry.normals.is_empty() {
        return false;
    }
    let ends = |triangle: u32, corner: usize| {
        let vertices = geometry.triangles[triangle as usize];
        [vertices[corner], vertices[(corner + 1) % 3]]
    };
    let here = ends(triangle, corner);
    let mut there = ends(across.triangle, across.corner);
    if !across.flipped {
        there.reverse();
    }
    let normal = |v: u32| geometry.normals[v as usize];
    here.into_iter()
        .zip(there)
        .any(|(v, w)| v != w && f64::from(normal(v).distance_squared(normal(w))) > FLAT)
}

/// The s for which a point α·a + β·b is parallel to (1−s)·a + s·b, from numbers proportional to β
/// and α with the same positive factor; infinite beyond the half-turn.
pub fn parameter(of_b: f64, of_a: f64) -> f64 {
    if of_a + of_b > 0.0 {
        of_b / (of_a + of_b)
    } else if of_b > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}
