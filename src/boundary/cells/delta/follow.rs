//! From a receiver in a delta light's shadow along a line of rays to where that shadow ends.

use super::receiver::{Receiver, Source};
use crate::boundary::occlusion::{MAX_OCCLUDERS, NEAREST};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::{HALVINGS, between};
use crate::discontinuity::crossing::Reservoir;
use crate::discontinuity::exit::parameter;
use crate::discontinuity::facets::{Facet, facets};
use crate::discontinuity::walk::{Walk, walk_among};
use crate::paths::counts::Counts;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// The largest step beyond a silhouette, as a part of a facet.
const MOST_STEP: f64 = 0.1;

/// Narrower parts of an arc are rounding.
const NARROWEST: f64 = 1e-9;

/// The rays between two that see known triangles.
pub struct Rays<F> {
    pub arc: Arc,
    pub seen: [u32; 2],
    /// What is seen at a parameter of the arc.
    pub first_hit: F,
}

/// Where a shadow ends.
#[derive(Clone, Copy, Debug)]
pub struct ShadowEnd {
    pub edge: [u32; 2],
    /// The triangle it falls on.
    pub receiver: u32,
    /// Parameter of the arc.
    pub s: f64,
}

/// What following a shadow came to; numbers are parameters of the arc.
#[derive(Clone, Copy, Debug)]
pub enum Followed {
    /// What throws it ends.
    Shadow(ShadowEnd),
    /// The surface that it falls on ends, or turns away from the light.
    Surface(f64),
    /// It goes on.
    AllHidden,
    /// It ends, and it is not known why.
    Lost(f64),
}

impl Followed {
    /// Where that is.
    pub fn end(&self) -> Option<f64> {
        match *self {
            Followed::Shadow(ShadowEnd { s, .. }) | Followed::Surface(s) | Followed::Lost(s) => {
                Some(s)
            }
            Followed::AllHidden => None,
        }
    }
}

/// Follows the shadow in which lies what the first ray sees, along the rays up to parameter
/// `limit`.
pub fn follow<F: Fn(f64) -> u32>(
    scene: &SearchScene,
    light: usize,
    rays: &Rays<F>,
    limit: f64,
    counts: &mut Counts,
) -> Followed {
    let (_, passed) = surface(scene, rays, limit, counts);
    let arc = &rays.arc;
    let mut from = 0.0;
    for Facet { triangle, to, .. } in passed {
        if to - from < NARROWEST {
            continue;
        }
        let receiver = Receiver::new(scene, light, triangle);
        match over_facet(scene, &receiver, arc, [from, to], counts) {
            Followed::AllHidden => from = to,
            ends => return ends,
        }
    }
    if limit - from > NARROWEST {
        Followed::Surface(from)
    } else {
        Followed::AllHidden
    }
}

/// Up to which parameter, `limit` at most, the surface is seen that the first ray meets, and its
/// triangles up to there.
pub fn surface<F: Fn(f64) -> u32>(
    scene: &SearchScene,
    rays: &Rays<F>,
    limit: f64,
    counts: &mut Counts,
) -> (f64, Vec<Facet>) {
    let end = surface_end(scene, rays, counts).min(limit);
    let [triangle, other] = rays.seen;
    let passed = if triangle == other {
        vec![Facet {
            triangle,
            to: end,
            corner: 0,
        }]
    } else {
        facets(
            scene.view.geometry,
            scene.adjacency,
            &rays.arc,
            triangle,
            end,
        )
    };
    (end, passed)
}

/// Up to which parameter the surface is seen that the first ray meets.
pub fn surface_end<F: Fn(f64) -> u32>(
    scene: &SearchScene,
    rays: &Rays<F>,
    counts: &mut Counts,
) -> f64 {
    let (geometry, adjacency) = (scene.view.geometry, scene.adjacency);
    let [a, mut b] = rays.seen;
    let [mut low, mut high] = [0.0, 1.0];
    for _ in 0..HALVINGS {
        let arc = Arc {
            b: rays.arc.direction(high),
            ..rays.arc
        };
        match between(geometry, adjacency, &arc, [a, b], None, 0.0) {
            Ok([None, _]) if high == 1.0 => return 1.0,
            Ok([None, _]) => low = high,
            // A part of the shorter arc, whose directions are of other lengths at their ends.
            Ok([Some(crossing), _]) => return high * crossing.s,
            Err(_) => {}
        }
        // Something stands before what is seen at both ends, or beyond `low`.
        let middle = if low == high {
            0.5 * (low + 1.0)
        } else {
            0.5 * (low + high)
        };
        counts.probe += 1;
        b = (rays.first_hit)(middle);
        high = middle;
    }
    low
}

/// Follows a shadow over one triangle, at whose beginning it hides the light.
fn over_facet(
    scene: &SearchScene,
    receiver: &Receiver,
    arc: &Arc,
    [from, to]: [f64; 2],
    counts: &mut Counts,
) -> Followed {
    let mut ends = [from, to].map(|s| receiver.point(arc.origin, arc.direction(s)));
    if from > 0.0 {
        // Right where a facet begins what it stands on may hide the light.
        let length = ends[0].distance(ends[1]);
        let beside = step(scene.view.geometry, ends[0], length);
        ends[0] = ends[0].lerp(ends[1], beside);
    }
    if !receiver.is_lit(ends[0], arc.direction(from)) {
        return Followed::Surface(from);
    }
    let on_arc = |at: f64| parameter_of(arc, ends[0].lerp(ends[1], at));
    match over_plane(scene, receiver, ends, counts) {
        OverPlane::Ends(edge, at) => Followed::Shadow(ShadowEnd {
            edge,
            receiver: receiver.triangle,
            s: on_arc(at),
        }),
        OverPlane::AllHidden => Followed::AllHidden,
        OverPlane::Lit if from == 0.0 => Followed::Lost(from),
        OverPlane::Lit => Followed::Surface(from),
        OverPlane::Lost(at) => Followed::Lost(on_arc(at)),
    }
}

/// What following a shadow from one point of a plane to another came to; numbers are parts of the
/// way.
pub enum OverPlane {
    /// The edge that throws it ends it.
    Ends([u32; 2], f64),
    AllHidden,
    /// There is none where it should begin.
    Lit,
    /// It ends, and it is not known why.
    Lost(f64),
}

/// Follows the shadow at one point of a receiver's plane toward another.
pub fn over_plane(
    scene: &SearchScene,
    receiver: &Receiver,
    [x_from, x_to]: [DVec3; 2],
    counts: &mut Counts,
) -> OverPlane {
    let point = |at: f64| x_from.lerp(x_to, at);
    let (lift, source) = (receiver.lift(x_from), receiver.source(x_from));
    let mut at = 0.0;
    counts.probe += 1;
    let mut occluder = receiver.occluder(x_from);
    if occluder == NO_TRIANGLE {
        return OverPlane::Lit;
    }
    for _ in 0..MAX_OCCLUDERS {
        let [a, b] = [point(at), x_to].map(|x| source.position(x + lift));
        let way = Arc {
            origin: DVec3::ZERO,
            a,
            b,
        };
        let fold = match walk_over(scene, &source, &way, occluder) {
            Walk::Fold(fold) => fold,
            Walk::Continues => return OverPlane::AllHidden,
            Walk::Reached | Walk::Lost => return OverPlane::Lost(at),
        };
        let crossing = at + fold.s.max(0.0) * (1.0 - at);
        at = crossing + step(scene.view.geometry, point(crossing), x_from.distance(x_to));
        if at >= 1.0 {
            return OverPlane::AllHidden;
        }
        counts.probe += 1;
        occluder = receiver.occluder(point(at));
        if occluder == NO_TRIANGLE {
            return OverPlane::Ends(fold.edge, crossing);
        }
    }
    OverPlane::Lost(at)
}

/// Walks over what throws a shadow, as rays from a delta light see it.
fn walk_over(scene: &SearchScene, source: &Source, way: &Arc, occluder: u32) -> Walk {
    let (geometry, adjacency) = (scene.view.geometry, scene.adjacency);
    let position = |v: u32| source.position(geometry.positions[v as usize].as_dvec3());
    let ends = [occluder, NO_TRIANGLE];
    let none = &mut Reservoir::closed();
    walk_among(position, geometry, adjacency, way, ends, 1.0, none)
}

/// How far beyond a silhouette single precision tells that the light is seen, in parts of `length`.
pub fn step(geometry: &Geometry, x: DVec3, length: f64) -> f64 {
    (NEAREST * geometry.room(x) / length).min(MOST_STEP)
}

/// The parameter at which an arc passes a point.
pub(super) fn parameter_of(arc: &Arc, x: DVec3) -> f64 {
    let (normal, v) = (arc.normal(), x - arc.origin);
    parameter(normal.dot(arc.a.cross(v)), normal.dot(v.cross(arc.b)))
}
