//! From an occluded ray to the silhouette behind which it would be free.

use super::tracer::{Counts, Surface, Tracer, lane_of};
use crate::trace::geometry::NO_TRIANGLE;
use crate::trace::{Coherence, Hits, MISS, Rays};
use crate::warp::adjacency::Adjacency;
use crate::warp::walk::{Arc, Fold, Reservoir, Walk, walk};
use glam::{DVec3, Vec3};

/// How far beyond a silhouette the probe looks, as a fraction of the cell.
pub const PROBE: f64 = 1e-3;
/// Occluders behind one another that are followed before a cell is given up.
const MAX_OCCLUDERS: usize = 8;

/// A point of a surface from which rays leave.
pub struct SurfacePoint {
    pub x: Vec3,
    pub geometric: Vec3,
}

impl SurfacePoint {
    pub fn of_lane(surface: &Surface, lane: usize) -> Self {
        Self {
            x: lane_of(surface.x, lane),
            geometric: lane_of(surface.geometric, lane),
        }
    }

    /// The first triangle on the way to x + `d`·`far`.
    pub fn first_hit(&self, tracer: &Tracer, d: DVec3, far: f32, counts: &mut Counts) -> u32 {
        counts.probe += 1;
        let d = d.as_vec3();
        // As `tracer::leave`, for one ray.
        let step = (self.x.abs().max_element() + 1.0) * 2e-5 * d.dot(self.geometric).signum();
        let mut ray = Rays::<1>::default();
        ray.set(0, self.x + self.geometric * step, d, 0.0, far);
        let mut hit = Hits::<1>::default();
        tracer
            .accel
            .intersect(&ray, 1, &mut hit, Coherence::Incoherent);
        match hit.mesh[0] {
            MISS => NO_TRIANGLE,
            mesh => tracer.geometry.first_triangle[mesh as usize] + hit.triangle[0],
        }
    }
}

/// Walks from the occluder that stands in the direction of coordinate `from` toward the free direction of
/// coordinate `to`; where another occluder stands behind the silhouette, on along that one. Returns the last
/// silhouette and its coordinate. `direction` is linear in the coordinate up to its length.
pub fn follow_occluders(
    tracer: &Tracer,
    adjacency: &Adjacency,
    point: &SurfacePoint,
    direction: &impl Fn(f64) -> DVec3,
    [from, to]: [f64; 2],
    far: f32,
    counts: &mut Counts,
) -> Option<(Fold, f64)> {
    let origin = point.x.as_dvec3();
    let mut at = from;
    for _ in 0..MAX_OCCLUDERS {
        let triangle = point.first_hit(tracer, direction(at), far, counts);
        if triangle == NO_TRIANGLE {
            return None;
        }
        let arc = Arc {
            origin,
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
        let is_past_end = (to - at) * (to - from) <= 0.0;
        if is_past_end || point.first_hit(tracer, direction(at), far, counts) == NO_TRIANGLE {
            return Some((fold, crossing));
        }
    }
    None
}
