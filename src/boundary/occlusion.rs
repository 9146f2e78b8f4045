//! From an occluded ray to the silhouette behind which it would be free.

use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Reservoir};
use crate::discontinuity::walk::{Fold, Walk, walk};
use crate::paths::at::At;
use crate::paths::counts::Counts;
use crate::paths::leaving::OFFSET;
use crate::paths::light::lamp::Lamp;
use crate::paths::rays::lane_of;
use crate::paths::scene_view::SceneView;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::{DVec3, Vec3};

/// How far beyond a silhouette probes look at most, as a fraction of the cell.
pub const PROBE: f64 = 1e-3;
/// The nearest that they may look, in coordinates: some 30 units in the last place.
pub const NEAREST: f64 = 2e-6;
/// Halvings of an interval in which the end of a shadow lies that nothing explains: its length is
/// wanted for the shadow's other end.
const BISECTIONS: u32 = 16;
/// Occluders behind one another that are followed before a cell is given up: the slats of a long
/// fence.
pub const MAX_OCCLUDERS: usize = 1024;

/// From acute edges of bodies with shading normals they keep this many times the distance from
/// surfaces at which rays start, but not more than this fraction. Shading normals send rays into a
/// body, and where that is a thin wedge what starts near its edge starts on its other side and gets
/// out. Likewise where surfaces pass through each other: what starts on one of them nearer to the
/// other than that starts on its other side.
const CLEAR: f64 = 10.0;
pub const MOST_PROBE: f64 = 0.1;

/// How far beside a crossing that is seen along `d` probes look: an angle as seen from `origin`, at
/// this `reach` from which rays begin,
/// and the fraction of the cell that it must not exceed. What the radiance changes by over that
/// distance is taken for a part of its jump, so it is as small as it can be.
pub fn probe_angle(
    geometry: &Geometry,
    crossing: &Crossing,
    (origin, reach): (DVec3, f64),
    d: DVec3,
) -> [f64; 2] {
    let Some(point) = crossing.boundary.seen_along(geometry, origin, d) else {
        return [f64::INFINITY, PROBE];
    };
    if crossing.is_tight() {
        let distance = clear_of(geometry, &crossing.boundary, point);
        [distance / point.distance(origin), MOST_PROBE]
    } else {
        [nearest_angle(geometry, point, origin, reach), PROBE]
    }
}

/// How far from a point of a tight boundary what starts there is clear of what lies beyond it.
pub fn clear_of(geometry: &Geometry, boundary: &Boundary, point: DVec3) -> f64 {
    let sine = match boundary {
        Boundary::Crease(triangles) => {
            let at = |v: u32| geometry.positions[v as usize].as_dvec3();
            let [na, nb] = triangles.map(|t| {
                let [p, q, r] = t.map(at);
                (q - p).cross(r - p).normalize()
            });
            na.cross(nb).length()
        }
        _ => 1.0,
    };
    CLEAR * f64::from(OFFSET) * geometry.room(point) / sine
}

/// The smallest angle, as seen from `origin`, at which single precision still tells two rays apart
/// that end near `point` and begin at this `reach` from `origin`.
pub fn nearest_angle(geometry: &Geometry, point: DVec3, origin: DVec3, reach: f64) -> f64 {
    let distance = point.distance(origin);
    NEAREST * (geometry.room(point) + distance - reach) / distance
}

/// A point of a surface from which rays leave.
pub struct SurfacePoint {
    pub x: Vec3,
    /// Unit normal of its triangle; where occluders are followed, on the side that is seen.
    pub geometric: Vec3,
    /// The triangle it lies on.
    pub triangle: u32,
    /// How far off the surface rays start.
    pub clearance: f32,
}

/// Where an occluder ends.
pub struct OccluderEnd {
    pub edge: [u32; 2],
    /// Where on the edge; `None` at the surface's own horizon, for which an edge of its triangle
    /// stands.
    pub along: Option<f64>,
    /// Coordinate of the crossing.
    pub at: f64,
}

impl SurfacePoint {
    pub fn new(geometry: &Geometry, x: Vec3, geometric: Vec3, triangle: u32) -> Self {
        let clearance = OFFSET * geometry.room(x.as_dvec3()) as f32;
        Self {
            x,
            geometric,
            triangle,
            clearance,
        }
    }

    pub fn of_lane(at: &At, lane: usize) -> Self {
        let geometric = lane_of(at.surface.geometric, lane);
        let direction = lane_of(at.vertices.direction, lane);
        let x = lane_of(at.surface.x, lane);
        let seen = geometric * -geometric.dot(direction).signum();
        Self::new(at.view.geometry, x, seen, at.vertices.triangle[lane])
    }

    /// The edge of its own triangle that spans the plane with it best.
    pub fn plane_edge(&self, view: &SceneView) -> [u32; 2] {
        let [a, b, c] = view.geometry.triangles[self.triangle as usize];
        let area = |&[v, w]: &[u32; 2]| {
            let [v, w] = [v, w].map(|v| view.geometry.positions[v as usize] - self.x);
            v.cross(w).length()
        };
        let edges = [[a, b], [b, c], [c, a]];
        edges
            .into_iter()
            .max_by(|p, q| area(p).total_cmp(&area(q)))
            .unwrap_or([a, b])
    }

    /// Where rays toward `d` start: as `rays::leave`. Walks that look for what these rays met start
    /// there too, or the ends of what is near would seem to lie elsewhere.
    pub fn leave(&self, d: DVec3) -> Vec3 {
        let side = d.as_vec3().dot(self.geometric).signum();
        self.x + self.geometric * (self.clearance * side)
    }

    /// From where rays start that leave for the point `y`, to there. `leave` starts on the same
    /// side: a `y` so near to the surface's plane that it lies between the two starts is moved into
    /// it.
    pub fn toward(&self, y: DVec3) -> DVec3 {
        let (x, n) = (self.x.as_dvec3(), self.geometric.as_dvec3());
        let height = (y - x).dot(n);
        let d = y - self.leave(y - x).as_dvec3();
        let least = f64::EPSILON.sqrt() * d.length();
        let lifted = d.dot(n) * height.signum();
        d + n * ((least - lifted).max(0.0) * height.signum())
    }

    /// The first triangle on the way along `d`, of `far` times its length.
    pub fn first_hit(&self, view: &SceneView, d: DVec3, far: f32) -> u32 {
        view.first_hit(self.leave(d), d.as_vec3(), 0.0, far)
    }
}

/// Where a light is looked for, over an interval.
pub struct Way<'a, D> {
    /// Linear in the coordinate up to its length.
    pub direction: &'a D,
    /// How far along it the light is.
    pub far: f32,
    /// What hides nothing.
    pub lamp: Option<&'a Lamp>,
    /// Whether coordinate 1 is known to be open.
    pub is_open_at_one: bool,
}

/// What following occluders over an interval came to.
pub enum Followed {
    /// The last one ends, and nothing hides what lies beyond.
    End(OccluderEnd),
    /// One hides after another, up to the interval's end.
    AllHidden,
    /// What hides ends here, and it is not known why.
    Lost(f64),
}

/// Walks from the occluder that stands in the direction of coordinate 0 toward coordinate 1, and
/// where another occluder stands behind the silhouette, on along that one.
pub fn follow_occluders<D: Fn(f64) -> DVec3>(
    scene: &SearchScene,
    point: &SurfacePoint,
    way: &Way<D>,
    counts: &mut Counts,
) -> Followed {
    let Way {
        direction,
        far,
        lamp,
        is_open_at_one,
    } = *way;
    let view = scene.view;
    let occluder = |at: f64, counts: &mut Counts| {
        counts.probe += 1;
        let triangle = point.first_hit(view, direction(at), far);
        is_occluder(triangle, lamp).then_some(triangle)
    };
    let lost = |at: f64, counts: &mut Counts| {
        let hides = |at: f64| occluder(at, counts).is_some();
        Followed::Lost(end_beyond(at, hides))
    };
    // A shading normal's horizon may reach below that of the triangle, whose own plane is then what
    // hides.
    let above = |at: f64| point.geometric.as_dvec3().dot(direction(at));
    let ([low, high], crossing) = horizon(above);
    let own_plane = || OccluderEnd {
        edge: point.plane_edge(view),
        along: None,
        at: crossing,
    };
    // What ends at `at`, behind which the next occluder stands; and up to where rays leave above.
    let (mut at, mut end, limit) = match (low < 0.0, high < 0.0) {
        (true, true) => return Followed::AllHidden,
        (true, false) => (crossing + PROBE, Some(own_plane()), 1.0),
        (false, true) => (0.0, None, crossing),
        (false, false) => (0.0, None, 1.0),
    };
    let whole_angle = direction(0.0).angle_between(direction(1.0));
    let mut passed = NO_TRIANGLE;
    for _ in 0..MAX_OCCLUDERS {
        if at >= limit && !is_open_at_one {
            return Followed::AllHidden;
        }
        let hiding = if at < 1.0 { occluder(at, counts) } else { None };
        let triangle = match (hiding, end) {
            (Some(triangle), _) => triangle,
            (None, Some(end)) => return Followed::End(end),
            (None, None) => return lost(at, counts),
        };
        if triangle == passed {
            return lost(at, counts);
        }
        passed = triangle;
        let ends = [direction(at), direction(1.0)];
        let start = point.leave(ends[0]).as_dvec3();
        let up_to = if at < limit { limit } else { 1.0 };
        let stop = (up_to - at) / (1.0 - at);
        let fold = match walk_over(scene, point, (triangle, stop), ends) {
            Walk::Fold(fold) => fold,
            Walk::Continues if !is_open_at_one => return Followed::AllHidden,
            Walk::Continues if up_to < 1.0 => {
                at = limit + PROBE;
                end = Some(own_plane());
                continue;
            }
            _ => return lost(at, counts),
        };
        let crossing = at + fold.s.max(0.0) * (1.0 - at);
        at = crossing + past(view.geometry, &fold, start, whole_angle);
        end = Some(OccluderEnd {
            edge: fold.edge,
            along: Some(fold.along),
            at: crossing,
        });
    }
    lost(at, counts)
}

/// How far above a plane the directions at both ends of an interval lead, and where they pass it.
/// Rays that leave on its other side start elsewhere, so that directions toward points jump there.
fn horizon(above: impl Fn(f64) -> f64) -> ([f64; 2], f64) {
    let [low, high] = [0.0, 1.0].map(&above);
    let mut crossing = low / (low - high);
    if low < 0.0 && high >= 0.0 && above(crossing + PROBE) < 0.0 {
        crossing = end_beyond(crossing, |at| above(at) < 0.0);
    }
    ([low, high], crossing)
}

/// How far past a silhouette the next occluder is looked for, as a part of the interval. Where the
/// edge is so near that single precision takes it for elsewhere, as under a sheet that lies on a
/// table, that is farther.
fn past(geometry: &Geometry, fold: &Fold, start: DVec3, whole_angle: f64) -> f64 {
    let least = nearest_angle(geometry, fold.point, start, 0.0) / whole_angle;
    PROBE.max(least.min(MOST_PROBE))
}

/// Where what hides coordinate `from` ends, if coordinate 1 is open; an end beyond it else.
fn end_beyond(from: f64, mut hides: impl FnMut(f64) -> bool) -> f64 {
    let [mut hidden, mut open] = [from, 1.0];
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (hidden + open);
        *(if hides(middle) {
            &mut hidden
        } else {
            &mut open
        }) = middle;
    }
    0.5 * (hidden + open)
}

/// Walks over the triangle that is `seen` in the first of two directions, and what hangs together
/// with it, toward the other, up to parameter `stop`.
fn walk_over(
    scene: &SearchScene,
    point: &SurfacePoint,
    (seen, stop): (u32, f64),
    [a, b]: [DVec3; 2],
) -> Walk {
    let arc = Arc {
        origin: point.leave(a).as_dvec3(),
        a,
        b,
    };
    walk(
        scene.view.geometry,
        scene.adjacency,
        &arc,
        [seen, NO_TRIANGLE],
        stop,
        &mut Reservoir::closed(),
    )
}

/// Whether a triangle that is seen hides the light.
pub fn is_occluder(triangle: u32, lamp: Option<&Lamp>) -> bool {
    triangle != NO_TRIANGLE && lamp.is_none_or(|lamp| lamp.patch(triangle).is_none())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rays start `clearance` off the plane on the side that they leave on, so that directions
    /// toward points lead less far off it, or along it ([`SurfacePoint::toward`]).
    #[test]
    fn a_horizon_at_which_directions_jump() {
        let clearance = 3e-5;
        let height = |at: f64| 0.0117 * at - 0.00188;
        let above = |at: f64| height(at).signum() * (height(at).abs() - clearance).max(1e-9);
        let ([low, high], crossing) = horizon(above);
        let straight = low / (low - high);
        assert!(above(straight + PROBE) < 0.0);
        assert!(above(crossing + PROBE) >= 0.0);
        assert!(height(crossing).abs() < 1e-6);
    }
}
