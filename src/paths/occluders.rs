//! From an occluded ray to the silhouette behind which it would be free.

use super::rays::{OFFSET, lane_of};
use super::surface::Surface;
use super::tracer::{Counts, Tracer};
use crate::lanes::LANES;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::Boundary;
use crate::warp::crossing::{Crossing, Kind, Reservoir};
use crate::warp::walk::{Arc, Walk, walk};
use glam::{DVec3, Vec3};

/// How far beyond a silhouette probes look at most, as a fraction of the cell.
pub const PROBE: f64 = 1e-3;
/// The nearest that they may look, in coordinates: some 30 units in the last place.
pub const NEAREST: f64 = 2e-6;
/// Occluders behind one another that are followed before a cell is given up.
const MAX_OCCLUDERS: usize = 64;

/// From acute edges of bodies with shading normals they keep this many times the distance from surfaces at which rays start, but not more than
/// this fraction. Shading normals send rays into a body, and where that is a thin wedge what starts near its edge starts on its other
/// side and gets out.
const CLEAR: f64 = 10.0;
pub const MOST_PROBE: f64 = 0.1;

/// How far beside a crossing probes look: an angle as seen from `origin`, and the fraction of the cell that it must not exceed. What
/// the radiance changes by over that distance is taken for a part of its jump, so it is as small as it can be.
pub fn probe_angle(geometry: &Geometry, crossing: &Crossing, origin: DVec3) -> [f64; 2] {
    let Boundary::Edge([v, w]) = crossing.boundary else {
        return [f64::INFINITY, PROBE];
    };
    let [v, w] = [v, w].map(|v| geometry.positions[v as usize].as_dvec3());
    let point = v.midpoint(w);
    if crossing.kind == Kind::ThinSilhouette {
        let room = point.abs().max_element() + 1.0;
        let angle = CLEAR * f64::from(OFFSET) * room / point.distance(origin);
        [angle, MOST_PROBE]
    } else {
        [nearest_angle(point, origin), PROBE]
    }
}

/// The smallest angle, as seen from `origin`, at which single precision still tells two rays apart that end near `point`.
pub fn nearest_angle(point: DVec3, origin: DVec3) -> f64 {
    let distance = point.distance(origin);
    let room = point.abs().max_element() + 1.0;
    NEAREST * (room + distance) / distance
}

/// A point of a surface from which rays leave.
pub struct SurfacePoint {
    pub x: Vec3,
    pub geometric: Vec3,
    /// The triangle it lies on.
    pub triangle: u32,
}

/// Where an occluder ends.
pub struct OccluderEnd {
    pub edge: [u32; 2],
    /// Where on the edge; `None` at the surface's own horizon, for which an edge of its triangle stands.
    pub along: Option<f64>,
    /// Coordinate of the crossing.
    pub at: f64,
}

impl SurfacePoint {
    pub fn of_lane(surface: &Surface, triangle: &[u32; LANES], lane: usize) -> Self {
        Self {
            x: lane_of(surface.x, lane),
            geometric: lane_of(surface.geometric, lane),
            triangle: triangle[lane],
        }
    }

    /// The edge of its own triangle that spans the plane with it best.
    pub(super) fn plane_edge(&self, tracer: &Tracer) -> [u32; 2] {
        let [a, b, c] = tracer.geometry.triangles[self.triangle as usize];
        let area = |&[v, w]: &[u32; 2]| {
            let [v, w] = [v, w].map(|v| tracer.geometry.positions[v as usize] - self.x);
            v.cross(w).length()
        };
        let edges = [[a, b], [b, c], [c, a]];
        edges
            .into_iter()
            .max_by(|p, q| area(p).total_cmp(&area(q)))
            .unwrap_or([a, b])
    }

    /// Where rays toward `d` start: as `rays::leave`. Walks that look for what these rays met start there too, or the
    /// ends of what is near would seem to lie elsewhere.
    pub fn leave(&self, d: DVec3) -> Vec3 {
        let side = d.as_vec3().dot(self.geometric).signum();
        let step = (self.x.abs().max_element() + 1.0) * OFFSET * side;
        self.x + self.geometric * step
    }

    /// The first triangle on the way along `d`, of `far` times its length.
    pub fn first_hit(&self, tracer: &Tracer, d: DVec3, far: f32, counts: &mut Counts) -> u32 {
        counts.probe += 1;
        tracer.first_hit(self.leave(d), d.as_vec3(), 0.0, far)
    }
}

/// An end of what hides the sky from a point, along a line of directions.
pub struct ShadowEdge {
    /// `None` where it was not found.
    pub boundary: Option<Boundary>,
    pub direction: DVec3,
    /// The directions between which it lies: one in which the sky is hidden, and one in which it is seen.
    pub hidden: usize,
    pub free: usize,
}

impl ShadowEdge {
    /// +1 if the sky is hidden beyond it, −1 if before it.
    pub fn sign(&self) -> f64 {
        if self.hidden > self.free { 1.0 } else { -1.0 }
    }
}

/// The ends of all shadows between `directions` in which the sky is seen (`is_open`) and those in which it is not.
pub fn shadow_edges(
    tracer: &Tracer,
    adjacency: &Adjacency,
    point: &SurfacePoint,
    directions: &[DVec3],
    is_open: &[bool],
    counts: &mut Counts,
) -> Vec<ShadowEdge> {
    let mut edges = Vec::new();
    for i in (0..is_open.len() - 1).filter(|&i| is_open[i] != is_open[i + 1]) {
        let (hidden, free) = if is_open[i] { (i + 1, i) } else { (i, i + 1) };
        let along = |s: f64| directions[hidden] * (1.0 - s) + directions[free] * s;
        let far = f32::INFINITY;
        let end = follow_occluders(tracer, adjacency, point, &along, [0.0, 1.0], far, counts);
        counts.unresolved += end.is_none() as u64;
        edges.push(ShadowEdge {
            direction: along(end.as_ref().map_or(0.5, |end| end.at)),
            boundary: end.map(|end| Boundary::Edge(end.edge)),
            hidden,
            free,
        });
    }
    edges
}

/// Walks from the occluder that stands in the direction of coordinate `from` toward the free direction of
/// coordinate `to`; where another occluder stands behind the silhouette, on along that one. Returns the last
/// silhouette. `direction` is linear in the coordinate up to its length.
pub fn follow_occluders(
    tracer: &Tracer,
    adjacency: &Adjacency,
    point: &SurfacePoint,
    direction: &impl Fn(f64) -> DVec3,
    [from, to]: [f64; 2],
    far: f32,
    counts: &mut Counts,
) -> Option<OccluderEnd> {
    let mut at = from;
    let is_free = |at: f64, counts: &mut Counts| {
        let is_past_end = (to - at) * (to - from) <= 0.0;
        is_past_end || point.first_hit(tracer, direction(at), far, counts) == NO_TRIANGLE
    };
    // A shading normal's horizon may reach below that of the triangle, whose own plane is then what hides.
    let height = |at: f64| point.geometric.as_dvec3().dot(direction(at));
    let (low, high) = (height(from), height(to));
    if low * high < 0.0 {
        let crossing = from + (to - from) * low / (low - high);
        at = crossing + PROBE * (to - from);
        if is_free(at, counts) {
            return Some(OccluderEnd {
                edge: point.plane_edge(tracer),
                along: None,
                at: crossing,
            });
        }
    }
    for _ in 0..MAX_OCCLUDERS {
        let triangle = point.first_hit(tracer, direction(at), far, counts);
        if triangle == NO_TRIANGLE {
            return None;
        }
        let arc = Arc {
            origin: point.leave(direction(at)).as_dvec3(),
            a: direction(at),
            b: direction(to),
        };
        let Walk::Fold(fold) = walk(
            tracer.geometry,
            adjacency,
            &arc,
            [triangle, NO_TRIANGLE],
            1.0,
            &mut Reservoir::closed(),
        ) else {
            return None;
        };
        let crossing = at + fold.s.max(0.0) * (to - at);
        at = crossing + PROBE * (to - from);
        if is_free(at, counts) {
            return Some(OccluderEnd {
                edge: fold.edge,
                along: Some(fold.along),
                at: crossing,
            });
        }
    }
    None
}
