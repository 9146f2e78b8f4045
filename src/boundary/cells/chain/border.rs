//! Where a border behind smooth surfaces really is.

use super::follow::{FirstRays, Followed};
use super::search::{Border, ChainSearch, Cut, Cuts, Way};
use crate::boundary::occlusion::{MOST_PROBE, NEAREST, PROBE, SurfacePoint, clear_of};
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::paths::boundary_sample::Shadow;
use crate::trace::geometry::Geometry;
use glam::Vec3;

/// Steps toward a border along a chain.
const STEPS: u32 = 24;
/// Places this far from each other tell of a slope, in parts of an interval.
const APART: f64 = 1e-8;
/// How near to where rays change sides of a plane to look, in parts of an interval.
const OWN_PLANE: f64 = 1e-4;
/// And how near to where something else hides a chain.
const BESIDE_HIDDEN: f64 = 1e-5;

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Where a crossing really is, and what is seen beside it.
    pub(super) fn border(
        &mut self,
        ends: [&Followed; 2],
        crossing: &Crossing,
        way: &Way,
    ) -> Option<Border> {
        let boundary = &crossing.boundary;
        let view = self.scene.view;
        let enough = |at: &Followed, slope| 0.02 * beside(view.geometry, at, crossing, slope);
        let (at, slope) = self.root(ends, (boundary, None, crossing.s), way, enough)?;
        let beside = beside(view.geometry, &at, crossing, slope);
        let places = [at.s - beside, at.s + beside];
        let [before, after] =
            places.map(|s| Followed::new(view, self.rays, s, &way.bends, self.counts));
        Some(Border {
            at,
            sides: [before?, after?],
        })
    }

    /// The two parts of an interval on either side of what hides the chain between its ends.
    /// For each end a place is given at which rays are bent otherwise. None of the line's points
    /// need see what hides the chain there, and where that ends is found where some do.
    pub(super) fn around(
        &mut self,
        ends: [Followed; 2],
        hidden: [f64; 2],
        way: &Way,
        out: &mut Cuts,
    ) -> [[Followed; 2]; 2] {
        let view = self.scene.view;
        let length = ends[1].s - ends[0].s;
        let sides = [0, 1].map(|i| {
            let (mut last, mut beyond) = (ends[i].clone(), hidden[i]);
            while (beyond - last.s).abs() > BESIDE_HIDDEN * length {
                let middle = 0.5 * (last.s + beyond);
                if middle == last.s || middle == beyond {
                    break;
                }
                match Followed::new(view, self.rays, middle, &way.bends, self.counts) {
                    Some(ray) if ray.is_bent_as(&last, view) => last = ray,
                    _ => beyond = middle,
                }
            }
            last
        });
        let [before, after] = sides.clone();
        out.cuts.push(Cut::unseen(sides));
        let [a, b] = ends;
        [[a, before], [after, b]]
    }

    /// Where rays change sides of the plane of the triangle that bends them last: within it, or
    /// where the next one begins. Otherwise a place between the two at which something hides the
    /// chain, if any.
    pub(super) fn own_plane(
        &mut self,
        ends: [&Followed; 2],
        way: &Way,
    ) -> Result<(Crossing, Border), Option<f64>> {
        let view = self.scene.view;
        let [mut a, mut b] = ends.map(Followed::clone);
        let length = b.s - a.s;
        while b.s - a.s > OWN_PLANE * length {
            let middle = 0.5 * (a.s + b.s);
            // An interval that is no more than rounding has no middle.
            if middle <= a.s || middle >= b.s {
                break;
            }
            let m = Followed::new(view, self.rays, middle, &way.bends, self.counts);
            let m = m.ok_or(Some(middle))?;
            let end = if m.leaks == a.leaks { &mut a } else { &mut b };
            *end = m;
        }
        let [t, u] = [&a, &b].map(|end| end.chain.last().map(|v| v.triangle));
        let (t, u) = (t.ok_or(None)?, u.ok_or(None)?);
        let corners = view.geometry.triangles[t as usize];
        let mut at = a.clone();
        let edge = if t == u {
            let point = SurfacePoint::new(view.geometry, at.origin.as_vec3(), Vec3::ZERO, t);
            point.plane_edge(view)
        } else {
            at.chain.pop();
            let corner = (0..3).find(|&corner| {
                let across = self.scene.adjacency.across(t, corner);
                across.is_some_and(|across| across.triangle == u)
            });
            let corner = corner.ok_or(None)?;
            [corners[corner], corners[(corner + 1) % 3]]
        };
        let boundary = Boundary::Edge(edge);
        let crossing = Crossing::new(boundary, Kind::FacetEdge, 0.0);
        Ok((crossing, Border { at, sides: [a, b] }))
    }

    /// The root of F along the chain near where rays that are not bent otherwise have it, and its
    /// slope there.
    pub(super) fn root(
        &mut self,
        [a, b]: [&Followed; 2],
        (boundary, shadow, near): (&Boundary, Option<Shadow>, f64),
        way: &Way,
        enough: impl Fn(&Followed, f64) -> f64,
    ) -> Option<(Followed, f64)> {
        let (scene, rays) = (self.scene, self.rays);
        let length = b.s - a.s;
        let [mut low, mut high] = [a, b].map(|end| (end.s, end.side(scene, boundary, shadow)));
        let is_bracketed = low.1 * high.1 < 0.0;
        let mut s = a.s + near.clamp(0.0, 1.0) * length;
        let mut last: Option<(f64, f64)> = None;
        let mut known = None;
        for step in 0..STEPS {
            let here = Followed::new(scene.view, rays, s, &way.bends, self.counts)?;
            let side = here.side(scene, boundary, shadow);
            // The slope between the last two places that rounding leaves apart; at first between
            // the ends, or a little beside.
            let measured = last.filter(|(t, _)| (s - t).abs() > APART * length);
            let slope = match (measured, known) {
                (Some((t, f)), _) => (side - f) / (s - t),
                (None, Some(known)) => known,
                _ if is_bracketed => (high.1 - low.1) / (high.0 - low.0),
                _ => {
                    let t = if s < a.s + 0.5 * length { 1.0 } else { -1.0 };
                    let t = s + 1e-3 * t * length;
                    let beside = Followed::new(scene.view, rays, t, &way.bends, self.counts)?;
                    (beside.side(scene, boundary, shadow) - side) / (t - s)
                }
            };
            if slope == 0.0 || !slope.is_finite() {
                return None;
            }
            if step > 0 && (side / slope).abs() <= enough(&here, slope) {
                return Some((here, slope));
            }
            (last, known) = (Some((s, side)), Some(slope));
            let mut next = s - side / slope;
            if is_bracketed {
                *(if side * low.1 > 0.0 {
                    &mut low
                } else {
                    &mut high
                }) = (s, side);
                let inside = next > low.0.min(high.0) && next < low.0.max(high.0);
                if !inside || step % 4 == 3 {
                    next = 0.5 * (low.0 + high.0);
                }
            }
            if !(a.s - 1e-3 * length..=b.s + 1e-3 * length).contains(&next) {
                return None;
            }
            s = next;
        }
        None
    }
}

/// How far beside a border to look: as near as single precision lets.
fn beside(geometry: &Geometry, at: &Followed, crossing: &Crossing, slope: f64) -> f64 {
    let Followed {
        origin, direction, ..
    } = *at;
    let boundary = &crossing.boundary;
    let Some(point) = boundary.seen_along(geometry, origin, direction) else {
        return PROBE;
    };
    let away = point.distance(origin);
    let (distance, most) = if crossing.is_tight() {
        (clear_of(geometry, boundary, point), MOST_PROBE)
    } else {
        (NEAREST * (geometry.room(point) + away), PROBE)
    };
    // F is c·d, and c stands on d.
    let c = boundary.normal(geometry, origin);
    let per_distance = c.length() * direction.length() / away;
    (distance * per_distance / slope.abs()).min(most)
}
