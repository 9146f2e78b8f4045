//! Where the beams of lights end on what the rays of a line see behind smooth surfaces.

use super::follow::{FirstRays, Followed};
use super::search::{ChainSearch, Run, Way};
use crate::boundary::cells::delta::receiver::Receiver;
use crate::boundary::cells::delta::rim::Rim;
use crate::boundary::occlusion::PROBE;
use crate::discontinuity::between::HALVINGS;
use crate::trace::geometry::NO_TRIANGLE;

/// How often a plane that touches a cone is taken anew, each time where the last was met.
const ROUNDS: usize = 2;

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Those on one surface. Where two neighbouring rays end on different triangles of it the
    /// interval between them is halved.
    pub(super) fn rim_on(&mut self, run: &Run, (light, rim): (usize, &Rim), way: &Way) {
        let view = self.scene.view;
        if run.rays.iter().any(|ray| ray.triangle == NO_TRIANGLE) {
            return;
        }
        for pair in run.rays.windows(2) {
            let ends = [&pair[0], &pair[1]].map(Followed::clone);
            let mut parts = vec![(ends, HALVINGS)];
            while let Some(([a, b], halvings)) = parts.pop() {
                if a.triangle == b.triangle {
                    self.rim_between([&a, &b], (light, rim), run.met, way);
                    continue;
                }
                let middle = 0.5 * (a.s + b.s);
                if halvings == 0 || middle <= a.s || middle >= b.s {
                    continue;
                }
                let middle = Followed::new(view, self.rays, middle, &way.bends, self.counts);
                if let Some(m) = middle.filter(|m| m.triangle != NO_TRIANGLE) {
                    parts.push(([m.clone(), b], halvings - 1));
                    parts.push(([a, m], halvings - 1));
                }
            }
        }
    }

    fn rim_between(
        &mut self,
        [a, b]: [&Followed; 2],
        (light, rim): (usize, &Rim),
        met: f64,
        way: &Way,
    ) {
        let view = self.scene.view;
        let receiver = Receiver::new(self.scene, light, a.triangle);
        let ends = [a, b].map(|ray| receiver.point(ray.origin, ray.direction));
        for crossing in rim.crossings(ends) {
            let x = ends[0].lerp(ends[1], crossing.at);
            if !receiver.sees_light(x, a.direction, self.counts) {
                continue;
            }
            let border = (crossing.boundary, light, crossing.at);
            let mut border = self.delta_border([a, b], border, way);
            // Ways of rays that are bent are not quite straight.
            for _ in 0..ROUNDS {
                let Some(Ok(found)) = &border else { break };
                let (origin, direction) = found.sides[0];
                let Some(touching) = rim.touching(receiver.point(origin, direction)) else {
                    break;
                };
                let near = ((found.s - a.s) / (b.s - a.s)).clamp(0.0, 1.0);
                border = self.delta_border([a, b], (touching, light, near), way);
            }
            let Some(Ok(mut found)) = border else {
                continue;
            };
            // On the border itself the light has no value.
            let inward = if crossing.goes_in { PROBE } else { -PROBE };
            let beside = found.s + inward * (b.s - a.s);
            let beside = Followed::new(view, self.rays, beside, &way.bends, self.counts);
            let Some(beside) = beside else { continue };
            found.sides = [(beside.origin, beside.direction); 2];
            found.weight *= if crossing.goes_in { -1.0 } else { 1.0 } / met;
            self.found.push(*found);
        }
    }
}
