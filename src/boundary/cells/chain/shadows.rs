//! Where the shadows of delta lights end on what the rays of a line see behind smooth surfaces.
//!
//! As on lines that see the shadows themselves (`boundary::cells::lobe::shadows`): from each ray
//! whose end is hidden from the light its shadow is followed to both of its ends. Where the last
//! rays of two neighbours end on one triangle, the straight way between these points stands for the
//! bent one, to find the edge that ends the shadow; where that really is, is found along the chain.

use super::follow::{FirstRays, Followed};
use super::search::{ChainSearch, Found, Run, Way};
use crate::boundary::cells::delta::follow::{OverPlane, over_plane};
use crate::boundary::cells::delta::receiver::Receiver;
use crate::boundary::cells::delta::rim::Rim;
use crate::discontinuity::between::{HALVINGS, Unresolved};
use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Shadow;
use crate::paths::chain_vertex::ChainVertex;
use crate::trace::geometry::NO_TRIANGLE;

/// How well a border is found, in parts of the interval between two rays.
const NEAR: f64 = 1e-6;

/// How a shadow goes on from a ray.
enum Reach {
    /// To the end of what the run sees.
    Rim,
    /// To its border.
    Border(Box<Found>),
    /// To a place where the surface ends that it falls on, or it is not known why.
    Other(f64),
}

impl Reach {
    fn place(&self) -> Option<f64> {
        match self {
            Reach::Rim => None,
            Reach::Border(found) => Some(found.s),
            Reach::Other(s) => Some(*s),
        }
    }
}

/// What lies between two rays, the first of which ends in a shadow.
enum Between {
    Border(Box<Found>),
    Hidden,
    /// It ends, and nothing moves there, or it is not known why.
    Other(f64),
}

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Finds the ends of shadows on what is seen along chains, on each surface, and of the beams of
    /// lights.
    pub(super) fn delta_lights(&mut self, runs: &[Run], way: &Way) {
        let view = self.scene.view;
        let bends = way.bends.len() as u32;
        let is_too_deep = self.depth + bends + 2 > view.limits.max_depth;
        if bends == 0 || is_too_deep || !self.scene.moving.anything() {
            return;
        }
        for run in runs {
            for light in 0..view.delta_lights.len() {
                self.of_light(run, light, way);
                if let Some(rim) = Rim::of(&view.delta_lights[light]) {
                    self.rim_on(run, (light, &rim), way);
                }
            }
        }
    }

    fn of_light(&mut self, run: &Run, light: usize, way: &Way) {
        let hidden: Vec<bool> = run.rays.iter().map(|r| self.is_hidden(r, light)).collect();
        let mut known_to = f64::NEG_INFINITY;
        for number in (0..hidden.len()).filter(|&n| hidden[n]) {
            if run.rays[number].s <= known_to {
                continue;
            }
            let [before, after] =
                [-1, 1].map(|step| self.reach(run, &hidden, (number, step), light, way));
            let chance = match [&before, &after].map(Reach::place) {
                [Some(from), Some(to)] => self.chance([from, to], way),
                _ => run.met,
            };
            known_to = after.place().unwrap_or(f64::INFINITY);
            // What the light brings is there before a shadow begins, and after it has ended.
            for (reach, sign) in [(before, 1.0), (after, -1.0)] {
                if let Reach::Border(mut found) = reach {
                    found.weight *= sign / chance;
                    self.found.push(*found);
                }
            }
        }
    }

    /// Whether a light could shine on where a ray ends, but something hides it.
    fn is_hidden(&mut self, ray: &Followed, light: usize) -> bool {
        if ray.triangle == NO_TRIANGLE {
            return false;
        }
        let receiver = Receiver::new(self.scene, light, ray.triangle);
        receiver.is_hidden(ray.origin, ray.direction, self.counts)
    }

    /// Whether where a ray ends faces a light.
    fn is_lit(&self, ray: &Followed, light: usize) -> bool {
        ray.triangle != NO_TRIANGLE && {
            let receiver = Receiver::new(self.scene, light, ray.triangle);
            receiver.is_lit(receiver.point(ray.origin, ray.direction), ray.direction)
        }
    }

    /// How the shadow in which ray `number` of a run ends goes on: to later rays (1) or to earlier
    /// ones (−1).
    fn reach(
        &mut self,
        run: &Run,
        hidden: &[bool],
        (number, step): (usize, isize),
        light: usize,
        way: &Way,
    ) -> Reach {
        let mut from = number;
        loop {
            let next = from.checked_add_signed(step);
            let Some(to) = next.filter(|&to| to < run.rays.len()) else {
                return Reach::Rim;
            };
            match self.shadow_between([&run.rays[from], &run.rays[to]], light, way) {
                Between::Border(found) => return Reach::Border(found),
                Between::Other(s) => return Reach::Other(s),
                Between::Hidden if hidden[to] => from = to,
                Between::Hidden => {
                    self.counts.unresolved += 1;
                    return Reach::Other(run.rays[to].s);
                }
            }
        }
    }

    /// Follows the shadow in which the first of two rays ends toward the end of the second. Where
    /// they end on different triangles the interval between them is halved.
    fn shadow_between(&mut self, ends: [&Followed; 2], light: usize, way: &Way) -> Between {
        let view = self.scene.view;
        let mut parts = vec![(ends.map(Followed::clone), HALVINGS)];
        while let Some(([a, b], halvings)) = parts.pop() {
            if a.s == b.s {
                continue;
            }
            if a.triangle == b.triangle {
                match self.on_triangle([&a, &b], light, way) {
                    Between::Hidden => continue,
                    ends => return ends,
                }
            }
            if view.geometry.coincide([a.triangle, b.triangle]) {
                self.counts.miss(Unresolved::Coincident);
                return Between::Other(a.s);
            }
            if halvings == 0 {
                if self.is_hidden(&b, light) {
                    continue;
                }
                // What faces away from the light is dark, too.
                return match self.is_lit(&b, light) {
                    true => self.lost(b.s),
                    false => Between::Other(b.s),
                };
            }
            let middle = 0.5 * (a.s + b.s);
            let Some(m) = Followed::new(view, self.rays, middle, &way.bends, self.counts) else {
                return self.lost(a.s);
            };
            parts.push(([m.clone(), b], halvings - 1));
            parts.push(([a, m], halvings - 1));
        }
        Between::Hidden
    }

    fn lost(&mut self, s: f64) -> Between {
        self.counts.unresolved += 1;
        Between::Other(s)
    }

    /// The same where both end on one triangle.
    fn on_triangle(&mut self, [a, b]: [&Followed; 2], light: usize, way: &Way) -> Between {
        let scene = self.scene;
        let receiver = Receiver::new(scene, light, a.triangle);
        let points = [a, b].map(|ray| receiver.point(ray.origin, ray.direction));
        let (edge, near) = match over_plane(scene, &receiver, points, self.counts) {
            OverPlane::Ends(edge, near) => (edge, near),
            OverPlane::AllHidden => return Between::Hidden,
            OverPlane::Lit => return self.lost(a.s),
            OverPlane::Lost(at) => return self.lost(a.s + at * (b.s - a.s)),
        };
        let boundary = Boundary::Edge(edge);
        let Some(found) = self.delta_border([a, b], (boundary, light, near), way) else {
            return self.lost(a.s + near * (b.s - a.s));
        };
        match found {
            Ok(found) => Between::Border(found),
            Err(s) => Between::Other(s),
        }
    }

    /// Where the border of what a light brings lies between two rays that end on one triangle, near
    /// a part of the way between these ends. If nothing moves there, only the place.
    pub(super) fn delta_border(
        &mut self,
        [a, b]: [&Followed; 2],
        (boundary, light, near): (Boundary, usize, f64),
        way: &Way,
    ) -> Option<Result<Box<Found>, f64>> {
        let shadow = Shadow {
            light: light as u32,
            receiver: a.triangle,
        };
        let (ends, near) = if a.s < b.s {
            ([a, b], near)
        } else {
            ([b, a], 1.0 - near)
        };
        let enough = NEAR * (ends[1].s - ends[0].s);
        let (at, _) = self.root(ends, (&boundary, Some(shadow), near), way, |_, _| enough)?;
        let (moving, geometry) = (self.scene.moving, self.scene.view.geometry);
        let first = |v: &ChainVertex| geometry.triangles[v.triangle as usize][0];
        let moves = self.rays.moves(at.s)
            || moving.boundary(geometry, &boundary)
            || moving.shines_anew(geometry, light, shadow.receiver)
            || at.chain.iter().any(|v| moving.vertex(geometry, first(v)));
        if !moves {
            return Some(Err(at.s));
        }
        Some(Ok(Box::new(Found {
            s: at.s,
            boundary,
            shadow: Some(shadow),
            weight: at.weight * way.inverse_chance,
            chain: at.chain,
            bends: way.bends.len(),
            sides: [(at.origin, at.direction); 2],
        })))
    }
}
