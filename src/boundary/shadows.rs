//! The ends of shadows on a line on which is seen only whether a light is hidden.
//!
//! A point of the line that is hidden lies in a *shadow*: an interval in which all is hidden. From
//! the point its occluders are followed to both of its ends, whatever lies elsewhere on the line.
//! So the shadow is found if any of the line's points lies in it, and the chance P of that follows
//! from its two ends alone. Both ends are weighed by 1/P (Horvitz & Thompson 1952). If they move
//! alike, as those of a thin thing do, what they bring together stays bounded however small P is.

use crate::boundary::occlusion::{Followed, OccluderEnd, SurfacePoint, Way, follow_occluders};
use crate::boundary::search_scene::SearchScene;
use crate::paths::counts::Counts;
use crate::paths::light::lamp::Lamp;
use glam::DVec3;

/// Shadows are taken to be met with this chance at least: it bounds the weight of their ends.
const SMALLEST_CHANCE: f64 = 1e-3;

/// The chance that one of several points lies in an interval: points at equal distances, in which
/// its length is given, and one more that lies in it with chance `extra`.
pub fn chance_of_any(length: f64, extra: f64) -> f64 {
    1.0 - (1.0 - length.min(1.0)) * (1.0 - extra)
}

/// A line of directions with a coordinate.
pub trait ShadowLine {
    /// The directions between two points, over 0 to 1.
    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3;

    /// The coordinate of part `s` of the directions between two points.
    fn coordinate(&self, ends: [f64; 2], s: f64) -> f64;

    /// How far along them the light is.
    fn far(&self) -> f32;

    /// What is seen on it, if that is one lamp: it hides nothing.
    fn lamp(&self) -> Option<&Lamp> {
        None
    }

    /// The chance that any of the line's points besides its two ends lies between two coordinates.
    fn chance_between(&self, interval: [f64; 2]) -> f64;
}

/// Where a shadow ends, with what that is to be weighed with.
pub struct ShadowEdge {
    pub end: OccluderEnd,
    /// The line's coordinate.
    pub at: f64,
    /// What the light's radiance jumps by there: +1 if it is hidden beyond, −1 if before, over the
    /// chance of finding it.
    pub jump: f64,
}

/// How a shadow goes on from a point.
enum Reach {
    /// To an end of the line.
    Rim,
    /// To where its last occluder ends, at a coordinate.
    Edge(OccluderEnd, f64),
    /// To this coordinate, and it is not known why.
    Lost(f64),
}

/// A line on which the ends of shadows are looked for.
pub struct Shadows<'a, L> {
    pub scene: &'a SearchScene<'a>,
    pub point: &'a SurfacePoint,
    pub line: &'a L,
    /// Of its points, increasing; the first and the last are its ends.
    pub points: &'a [f64],
    /// Whether they are open.
    pub is_open: &'a [bool],
}

impl<L: ShadowLine> Shadows<'_, L> {
    /// The ends of all shadows in which a point lies.
    pub fn edges(&self, counts: &mut Counts) -> Vec<ShadowEdge> {
        let mut edges = Vec::new();
        let mut known_to = f64::NEG_INFINITY;
        for (number, &point) in self.points.iter().enumerate() {
            if self.is_open[number] || point <= known_to {
                continue;
            }
            let before = self.reach(number, -1, counts);
            let after = self.reach(number, 1, counts);
            let chance = match [&before, &after].map(|r| r.coordinate()) {
                [Some(low), Some(high)] => self.line.chance_between([low, high]),
                _ => 1.0,
            };
            known_to = after.coordinate().unwrap_or(f64::INFINITY);
            let weight = 1.0 / chance.max(SMALLEST_CHANCE);
            for (reach, jump) in [(before, weight), (after, -weight)] {
                match reach {
                    Reach::Rim => {}
                    Reach::Lost(_) => counts.unresolved += 1,
                    Reach::Edge(end, at) => edges.push(ShadowEdge { end, at, jump }),
                }
            }
        }
        edges
    }

    /// How the shadow in which a point lies goes on from there: up the line (1) or down it (-1).
    fn reach(&self, number: usize, step: isize, counts: &mut Counts) -> Reach {
        let Self {
            scene, point, line, ..
        } = *self;
        let mut from = number;
        loop {
            let Some(to) = from
                .checked_add_signed(step)
                .filter(|&t| t < self.points.len())
            else {
                return Reach::Rim;
            };
            let ends = [self.points[from], self.points[to]];
            if ends[0] == ends[1] {
                // Points beyond an end of the line were put there.
                from = to;
                continue;
            }
            let between = line.between(ends);
            let way = Way {
                direction: &between,
                far: line.far(),
                lamp: line.lamp(),
                is_open_at_one: self.is_open[to],
            };
            match follow_occluders(scene, point, &way, counts) {
                Followed::End(end) => {
                    let at = line.coordinate(ends, end.at);
                    return Reach::Edge(end, at);
                }
                Followed::Lost(at) => return Reach::Lost(line.coordinate(ends, at)),
                Followed::AllHidden => from = to,
            }
        }
    }
}

impl Reach {
    /// `None` at an end of the line.
    fn coordinate(&self) -> Option<f64> {
        match *self {
            Reach::Rim => None,
            Reach::Edge(_, at) | Reach::Lost(at) => Some(at),
        }
    }
}
