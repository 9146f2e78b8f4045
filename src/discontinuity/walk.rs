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
use crate::discontinuity::exit::{Exit, Gauge, Gauged};
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
    let gauge = Gauge::new(arc);
    let end = |vertex: u32| {
        let point = position(vertex);
        let at = gauge.of(point);
        End { vertex, point, at }
    };
    // A walk stays on one mesh.
    let is_smooth = geometry.smooth[geometry.mesh_of_triangle[start as usize] as usize];
    let has_texture_edges = geometry.pattern(start).is_some();
    let texture_lines = |triangle: u32, part: [f64; 2], ridges: &mut Reservoir| {
        let points = geometry.triangles[triangle as usize].map(&position);
        for (line, s) in texture_edges::lines(geometry, triangle, points, arc, part) {
            ridges.meet(Crossing::ridge(line, s));
        }
    };
    let mut triangle = start;
    let corners = geometry.triangles[start as usize].map(end);
    let mut plane = plane_of(corners.map(|c| c.point));
    let mut facing = corners[0].point.dot(plane) < 0.0;
    // The edge by which the arc leaves the triangle.
    let Some((mut corner, mut from, mut to)) = way_out(corners) else {
        return Walk::Lost;
    };
    let mut entered_at = 0.0;
    for _ in 0..MAX_STEPS {
        let exit = Exit::new(from.at, to.at);
        let s = exit.s();
        if has_texture_edges && ridges.is_open() {
            texture_lines(triangle, [entered_at, s.min(limit)], ridges);
            entered_at = s;
        }
        // To the last bit: a limit may be where another walk has ended.
        if s >= limit {
            ridges.settle(limit);
            return Walk::Continues;
        }
        let fold = |is_thin: bool| Fold {
            edge: [from.vertex, to.vertex],
            s,
            along: exit.along(),
            point: from.point.lerp(to.point, exit.along()) + arc.origin,
            is_thin,
        };
        let Some(across) = adjacency.across(triangle, corner) else {
            ridges.settle(s);
            return Walk::Fold(fold(false));
        };
        // The points of the common edge are known, though each triangle may have vertices of its
        // own there; only the third point is new.
        let vertices = geometry.triangles[across.triangle as usize];
        let [second_corner, third_corner] = [1, 2].map(|i| (across.corner + i) % 3);
        let third = end(vertices[third_corner]);
        let [mut first, mut second] = if across.flipped {
            [from, to]
        } else {
            [to, from]
        };
        (first.vertex, second.vertex) = (vertices[across.corner], vertices[second_corner]);
        // In the triangle's own order: it faces the same way whatever edge it is entered by.
        let points = match third_corner {
            0 => [third, first, second],
            1 => [second, third, first],
            _ => [first, second, third],
        };
        let points = points.map(|end| end.point);
        let plane_across = plane_of(points);
        facing ^= across.flipped;
        if (points[0].dot(plane_across) < 0.0) != facing {
            ridges.settle(s);
            let is_acute = (plane.dot(plane_across) < 0.0) != across.flipped;
            return Walk::Fold(fold(is_smooth && is_acute));
        }
        if ridges.is_open() {
            let ridge = || Crossing::ridge(Boundary::Edge(fold(false).edge), s);
            let bend = bend(plane, plane_across);
            if (bend > FLAT && !is_smooth)
                || (is_smooth && is_torn(geometry, triangle, corner, &across))
                || (has_texture_edges
                    && texture_edges::is_seam(geometry, triangle, corner, &across))
            {
                ridges.meet(ridge());
            } else if bend > FLAT {
                ridges.meet_facet_edge(ridge(), (bend / COARSE).min(1.0));
            }
        }
        if across.triangle == goal {
            if has_texture_edges && ridges.is_open() {
                texture_lines(goal, [s, 1.0], ridges);
            }
            ridges.settle(f64::INFINITY);
            return Walk::Reached;
        }
        // Of the common edge one end lies on either side of the arc's plane.
        (corner, from, to) = match third.at.is_on_side_of(first.at) {
            true => (second_corner, second, third),
            false => (third_corner, third, first),
        };
        (triangle, plane) = (across.triangle, plane_across);
    }
    Walk::Lost
}

/// The edge by which the arc leaves the first triangle, and the corner at which it starts. The ray
/// itself passes between two crossings, of which it is the one that lies toward b.
#[inline(always)]
fn way_out([p, q, r]: [End; 3]) -> Option<(usize, End, End)> {
    let [pq, qr, rp] = [(p, q), (q, r), (r, p)].map(|(from, to)| !from.at.is_on_side_of(to.at));
    // The corner that lies alone on its side, and the others in their order.
    let (corner, alone, after, before) = match (pq, qr, rp) {
        (true, _, true) => (0, p, q, r),
        (true, true, _) => (1, q, r, p),
        (_, true, true) => (2, r, p, q),
        _ => return None,
    };
    let exits = [
        Exit::new(alone.at, after.at),
        Exit::new(before.at, alone.at),
    ];
    let [there, here] = exits.map(|exit| exit.toward_b());
    Some(match there > here {
        true => (corner, alone, after),
        false => ((corner + 2) % 3, before, alone),
    })
}

/// An end of an edge.
#[derive(Clone, Copy)]
struct End {
    vertex: u32,
    point: DVec3,
    at: Gauged,
}

/// Across the plane of a triangle.
fn plane_of([p, q, r]: [DVec3; 3]) -> DVec3 {
    (q - p).cross(r - p)
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
    let planes = [here, there].map(plane_of);
    let sine = bend(planes[0], planes[1]);
    let [n, m] = planes.map(DVec3::normalize_or_zero);
    let m = if across.flipped { -m } else { m };
    Bend {
        squared_sine: (sine > FLAT).then_some(sine),
        is_acute: n.dot(m) < 0.0,
        normals: [n, m],
        share: (sine / COARSE).min(1.0),
        is_torn: is_torn(geometry, triangle, corner, across),
    }
}

/// The squared sine of the angle between two planes, from vectors across them.
pub(super) fn bend(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length_squared() / (a.length_squared() * b.length_squared())
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discontinuity::facets::facets;
    use crate::discontinuity::outline::tests::geometry;
    use crate::trace::geometry::NO_TRIANGLE;
    use glam::{dvec3, vec3};

    const QUADS: u32 = 3;

    /// A strip of the plane z = −1 along x, whose triangles have vertices of their own, and one of
    /// which is wound the other way round.
    fn strip() -> Geometry {
        let corner = |i: u32, up: bool| {
            let y = if up { 0.47 } else { -0.53 };
            vec3(0.7371 * i as f32, y + 0.013 * i as f32, -1.0)
        };
        let mut positions = Vec::new();
        for i in 0..QUADS {
            let [p, q, r, s] = [(i, false), (i + 1, false), (i + 1, true), (i, true)];
            for (i, up) in [p, q, s, q, r, s] {
                positions.push(corner(i, up));
            }
        }
        let mut triangles: Vec<[u32; 3]> = (0..2 * QUADS)
            .map(|t| [0, 1, 2].map(|i| 3 * t + i))
            .collect();
        triangles[3].swap(0, 1);
        geometry(positions, triangles)
    }

    /// A walk ends at an edge of the triangle that it has come to, and to the last bit where what
    /// passes over the triangles leaves that one.
    #[test]
    fn ends_are_those_of_the_last_triangle() {
        let strip = strip();
        let adjacency = Adjacency::new(&strip);
        for k in 0..50 {
            let y = 0.011 * f64::from(k) - 0.27;
            let arc = Arc {
                origin: DVec3::ZERO,
                a: dvec3(0.1, 0.05, -1.0),
                b: dvec3(4.0, y, -1.0),
            };
            let ends = [0, NO_TRIANGLE];
            let none = &mut Reservoir::closed();
            let Walk::Fold(fold) = walk(&strip, &adjacency, &arc, ends, 1.0, none) else {
                panic!("no end at {y}");
            };
            let last = 2 * QUADS - 1;
            let own = strip.triangles[last as usize];
            assert!(fold.edge.iter().all(|v| own.contains(v)), "{fold:?}");
            let passed = facets(&strip, &adjacency, &arc, 0, fold.s);
            let end = passed.last().expect("a triangle");
            assert_eq!((end.triangle, end.to), (last, fold.s));
        }
    }
}
