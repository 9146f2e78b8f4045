//! From a visible point to the silhouette: walking over a mesh, triangle by triangle, along a straight line of
//! the image.
//!
//! Two rays of a bundle share the origin o and have directions d_a, d_b. If one of them hits an occluder and
//! the other misses it, then somewhere between them the occluder's silhouette crosses the arc from d_a to d_b.
//! Loubet et al. follow the point that was hit; a point that is *on* the silhouette moves exactly as the
//! discontinuity does, whatever the motion (a turning screw, a growing sphere), so we walk to it: from the
//! triangle that was hit across the edges that the plane of (o, d_a, d_b) cuts, until the next triangle faces
//! away or there is none. No ray is traced. All arithmetic is in f64: the walk's decisions are made from
//! vertices alone and are the same from both sides of an edge.

use super::adjacency::Adjacency;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// Triangles crossed before a walk is given up. An arc of the image that is longer than that in triangles
/// belongs to a mesh far finer than the sampling.
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
}

/// What a walk from a's hit toward b came to.
#[derive(Clone, Copy, Debug)]
pub enum Walk {
    /// The silhouette was reached before the arc's end.
    Fold(Fold),
    /// The triangle that was asked for was reached: both rays see one connected surface. With one of the edges that were
    /// crossed at which the surface bends, and their number: there the normals of a flat-shaded mesh jump.
    Reached(Option<(Fold, u32)>),
    /// The surface continues beyond the arc's end.
    Continues,
    /// Rounding or a degenerate triangle stopped the walk, or it was too long.
    Lost,
}

/// The arc of directions between two rays from one origin.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    pub origin: DVec3,
    pub a: DVec3,
    pub b: DVec3,
}

impl Arc {
    /// The same arc from its other end.
    pub fn reversed(self) -> Self {
        Self { origin: self.origin, a: self.b, b: self.a }
    }

    /// The direction at parameter `s`.
    pub fn direction(&self, s: f64) -> DVec3 {
        self.a * (1.0 - s) + self.b * s
    }
}

/// Walks from `start`, the triangle that the ray along `arc.a` hit, toward `arc.b`, whose ray hit
/// `goal`. `choice` in [0, 1) picks among the edges that the walk crosses.
pub fn walk(geometry: &Geometry, adjacency: &Adjacency, arc: &Arc, start: u32, goal: u32, choice: f64) -> Walk {
    let normal = arc.a.cross(arc.b);
    let corners = |t: u32| geometry.triangles[t as usize];
    let position = |v: u32| geometry.positions[v as usize].as_dvec3() - arc.origin;
    let faces = |t: u32| {
        let [p, q, r] = corners(t).map(position);
        p.dot((q - p).cross(r - p)) < 0.0
    };

    let mut triangle = start;
    let mut facing = faces(start);
    let mut entered_by = None;
    let mut ridges = Ridges { chosen: None, count: 0, choice };
    for _ in 0..MAX_STEPS {
        let vertices = corners(triangle);
        let points = vertices.map(position);
        let side = points.map(|p| normal.dot(p));
        let mut exit: Option<(usize, f64, f64, DVec3)> = None;
        for corner in 0..3 {
            let next = (corner + 1) % 3;
            if Some(corner) == entered_by || (side[corner] >= 0.0) == (side[next] >= 0.0) {
                continue;
            }
            let along = side[corner] / (side[corner] - side[next]);
            let point = points[corner].lerp(points[next], along);
            // In the first triangle the ray itself passes between the two crossings: the way out is toward b.
            let toward_b = normal.dot(arc.a.cross(point));
            if exit.is_none_or(|(_, best, ..)| toward_b > best) {
                exit = Some((corner, toward_b, along, point));
            }
        }
        let Some((corner, toward_b, along, point)) = exit else { return Walk::Lost };
        let s = parameter(toward_b, normal.dot(point.cross(arc.b)));
        if s >= 1.0 {
            return Walk::Continues;
        }
        let edge = [vertices[corner], vertices[(corner + 1) % 3]];
        let fold = Fold { edge, s, along, point: point + arc.origin };
        let Some(across) = adjacency.across(triangle, corner) else { return Walk::Fold(fold) };
        facing ^= across.flipped;
        if faces(across.triangle) != facing {
            return Walk::Fold(fold);
        }
        if goal != NO_TRIANGLE && bend(points, corners(across.triangle).map(position)) > FLAT {
            ridges.meet(fold);
        }
        if across.triangle == goal {
            return Walk::Reached(ridges.chosen.map(|fold| (fold, ridges.count)));
        }
        triangle = across.triangle;
        entered_by = Some(across.corner);
    }
    Walk::Lost
}

/// One edge out of a stream of unknown length, each with the same chance (a reservoir of one whose random number is
/// stretched after each decision).
struct Ridges {
    chosen: Option<Fold>,
    count: u32,
    choice: f64,
}

impl Ridges {
    fn meet(&mut self, fold: Fold) {
        self.count += 1;
        let chance = 1.0 / self.count as f64;
        if self.choice < chance {
            self.chosen = Some(fold);
            self.choice /= chance;
        } else {
            self.choice = (self.choice - chance) / (1.0 - chance);
        }
    }
}

/// The squared sine of the angle between the planes of two triangles; below this they are one plane.
const FLAT: f64 = 1e-10;

fn bend(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
    let [na, nb] = [a, b].map(|[p, q, r]| (q - p).cross(r - p));
    na.cross(nb).length_squared() / (na.length_squared() * nb.length_squared())
}

/// The s for which a point α·a + β·b is parallel to (1−s)·a + s·b, from numbers proportional to β and α with the
/// same positive factor; infinite beyond the half-turn.
fn parameter(of_b: f64, of_a: f64) -> f64 {
    if of_a + of_b > 0.0 {
        of_b / (of_a + of_b)
    } else if of_b > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}
