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
    [start, goal]: [u32; 2],
    limit: f64,
    ridges: &mut Reservoir,
) -> Walk {
    let walker = Walker::new(geometry, arc, start);
    let mut here = walker.first_step(start);
    for _ in 0..MAX_STEPS {
        let Some(exit) = walker.exit(&here) else {
            return Walk::Lost;
        };
        walker.meet_texture_edges(&here, [here.entered_at, exit.s.min(limit)], ridges);
        if exit.s >= limit {
            ridges.settle(limit);
            return Walk::Continues;
        }
        let fold = here.fold(&exit, arc.origin);
        let Some(across) = adjacency.across(here.triangle, exit.corner) else {
            ridges.settle(exit.s);
            return Walk::Fold(fold);
        };
        let there = walker.next_step(&here, &exit, &across);
        if there.faces() != there.facing {
            ridges.settle(exit.s);
            return Walk::Fold(Fold {
                is_thin: walker.is_smooth && is_acute(here.points, there.points, across.flipped),
                ..fold
            });
        }
        if ridges.is_open() {
            walker.meet_ridge(&here, &there, &exit, &across, ridges);
        }
        if there.triangle == goal {
            walker.meet_texture_edges(&there, [exit.s, 1.0], ridges);
            ridges.settle(f64::INFINITY);
            return Walk::Reached;
        }
        here = there;
    }
    Walk::Lost
}

/// What stays the same on the way.
struct Walker<'a> {
    geometry: &'a Geometry,
    arc: &'a Arc,
    /// Of the arc's plane.
    normal: DVec3,
    /// Of the mesh, on which a walk stays.
    is_smooth: bool,
    has_texture_edges: bool,
}

/// A triangle on the way.
struct Step {
    triangle: u32,
    vertices: [u32; 3],
    /// Seen from the arc's origin.
    points: [DVec3; 3],
    /// Their heights over the arc's plane.
    side: [f64; 3],
    /// Whether the walk's side of the surface is that from which the triangle is wound
    /// counter-clockwise.
    facing: bool,
    /// The corner that starts the edge by which it was entered.
    entered_by: Option<usize>,
    entered_at: f64,
}

/// Where the arc leaves a triangle.
struct Exit {
    /// The corner that starts the edge.
    corner: usize,
    along: f64,
    point: DVec3,
    s: f64,
}

impl<'a> Walker<'a> {
    fn new(geometry: &'a Geometry, arc: &'a Arc, start: u32) -> Self {
        Self {
            geometry,
            arc,
            normal: arc.a.cross(arc.b),
            is_smooth: geometry.smooth[geometry.mesh_of_triangle[start as usize] as usize],
            has_texture_edges: geometry.pattern(start).is_some(),
        }
    }

    fn position(&self, vertex: u32) -> DVec3 {
        self.geometry.positions[vertex as usize].as_dvec3() - self.arc.origin
    }

    fn first_step(&self, triangle: u32) -> Step {
        let vertices = self.geometry.triangles[triangle as usize];
        let points = vertices.map(|v| self.position(v));
        let mut step = Step {
            triangle,
            vertices,
            points,
            side: points.map(|p| self.normal.dot(p)),
            facing: true,
            entered_by: None,
            entered_at: 0.0,
        };
        step.facing = step.faces();
        step
    }

    fn exit(&self, step: &Step) -> Option<Exit> {
        let Step { side, points, .. } = step;
        let mut exit: Option<(usize, f64, f64, DVec3)> = None;
        for corner in 0..3 {
            let next = (corner + 1) % 3;
            if Some(corner) == step.entered_by || (side[corner] >= 0.0) == (side[next] >= 0.0) {
                continue;
            }
            let along = side[corner] / (side[corner] - side[next]);
            let point = points[corner].lerp(points[next], along);
            // In the first triangle the ray itself passes between the two crossings: the way out is
            // toward b.
            let toward_b = self.normal.dot(self.arc.a.cross(point));
            if exit.is_none_or(|(_, best, ..)| toward_b > best) {
                exit = Some((corner, toward_b, along, point));
            }
        }
        exit.map(|(corner, toward_b, along, point)| Exit {
            corner,
            along,
            point,
            s: parameter(toward_b, self.normal.dot(point.cross(self.arc.b))),
        })
    }

    /// The triangle across the edge: the points of that are known, and only the third is new.
    fn next_step(&self, here: &Step, exit: &Exit, across: &Across) -> Step {
        let next = (exit.corner + 1) % 3;
        let [first, second, third] = [0, 1, 2].map(|i| (across.corner + i) % 3);
        let [at_first, at_second] = if across.flipped {
            [exit.corner, next]
        } else {
            [next, exit.corner]
        };
        let vertices = self.geometry.triangles[across.triangle as usize];
        let (mut points, mut side) = (here.points, here.side);
        points[first] = here.points[at_first];
        points[second] = here.points[at_second];
        points[third] = self.position(vertices[third]);
        side[first] = here.side[at_first];
        side[second] = here.side[at_second];
        side[third] = self.normal.dot(points[third]);
        Step {
            triangle: across.triangle,
            vertices,
            points,
            side,
            facing: here.facing ^ across.flipped,
            entered_by: Some(across.corner),
            entered_at: exit.s,
        }
    }

    /// Shows the texture edges that the arc crosses on a triangle between two of its parameters.
    fn meet_texture_edges(&self, step: &Step, part: [f64; 2], ridges: &mut Reservoir) {
        if self.has_texture_edges && ridges.is_open() {
            for (line, s) in
                texture_edges::lines(self.geometry, step.triangle, step.points, self.arc, part)
            {
                ridges.meet(Crossing::ridge(line, s));
            }
        }
    }

    /// Shows the edge between two triangles, if the radiance may jump there.
    fn meet_ridge(
        &self,
        here: &Step,
        there: &Step,
        exit: &Exit,
        across: &Across,
        ridges: &mut Reservoir,
    ) {
        let (geometry, triangle, corner) = (self.geometry, here.triangle, exit.corner);
        let ridge = Crossing::ridge(Boundary::Edge(here.edge(corner)), exit.s);
        let bend = bend(here.points, there.points);
        if (bend > FLAT && !self.is_smooth)
            || (self.is_smooth && is_torn(geometry, triangle, corner, across))
            || (self.has_texture_edges
                && texture_edges::is_seam(geometry, triangle, corner, across))
        {
            ridges.meet(ridge);
        } else if bend > FLAT {
            ridges.meet_facet_edge(ridge, (bend / COARSE).min(1.0));
        }
    }
}

impl Step {
    /// The edge that starts at a corner.
    fn edge(&self, corner: usize) -> [u32; 2] {
        [self.vertices[corner], self.vertices[(corner + 1) % 3]]
    }

    /// Whether the origin is on the side from which it is wound counter-clockwise.
    fn faces(&self) -> bool {
        let [p, q, r] = self.points;
        p.dot((q - p).cross(r - p)) < 0.0
    }

    fn fold(&self, exit: &Exit, origin: DVec3) -> Fold {
        Fold {
            edge: self.edge(exit.corner),
            s: exit.s,
            along: exit.along,
            point: exit.point + origin,
            is_thin: false,
        }
    }
}

/// Whether two triangles with a common edge form an acute angle.
fn is_acute(here: [DVec3; 3], there: [DVec3; 3], flipped: bool) -> bool {
    let [here, there] = [here, there].map(|[p, q, r]| (q - p).cross(r - p));
    (here.dot(there) < 0.0) != flipped
}

/// Below this [`bend`] two triangles lie in one plane, and their common edge is not looked at.
const FLAT: f64 = 1e-10;

/// Above this, a tenth of a radian, all bends of smooth surfaces are looked at; of those below, as
/// many as leave each about as much to bring: the part of a hemisphere that lies between two planes
/// goes as the square of their angle.
const COARSE: f64 = 1e-2;

/// The squared sine of the angle between the planes of two triangles.
fn bend(a: [DVec3; 3], b: [DVec3; 3]) -> f64 {
    let [na, nb] = [a, b].map(|[p, q, r]| (q - p).cross(r - p));
    na.cross(nb).length_squared() / (na.length_squared() * nb.length_squared())
}

/// Whether the shading normals on the two sides of an edge differ, whose vertices each side has for
/// itself: so programs write bodies with hard edges.
fn is_torn(geometry: &Geometry, triangle: u32, corner: usize, across: &Across) -> bool {
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
fn parameter(of_b: f64, of_a: f64) -> f64 {
    if of_a + of_b > 0.0 {
        of_b / (of_a + of_b)
    } else if of_b > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}
