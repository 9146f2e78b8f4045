//! Reciprocal-probability estimates with a control variate [Booth2007, Zeltner2020], for the ends
//! of shadows on a line on which is seen only whether a light is hidden.
//!
//! Points are put on a line at random, and between a point that is hidden and a neighbour that is
//! not, the end of the shadow that hides the first is found. If there were no other borders on the
//! line than those that were found, the chance of that would be known (`boundary::inclusion`). But
//! another shadow may be so thin that no point met it. Draws until the end is found again, N, are
//! 1/P on average, whatever is on the line; draws until it would be found if nothing else were
//! there, M, are 1/P′ on average, P′ being the chance that is known. So 1/P′ + N − M is 1/P on
//! average, and with the same draws for both it is 1/P′ and has no noise at all unless something
//! else is there.

use crate::boundary::inclusion::Intervals;
use crate::boundary::occlusion::{OccluderEnd, PROBE, SurfacePoint, follow_occluders};
use crate::boundary::search_scene::SearchScene;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Branch;
use crate::paths::random::Stream;
use crate::trace::geometry::NO_TRIANGLE;
use glam::DVec3;

/// No end stands for more than this.
const MOST_DRAWS: u32 = 1000;

/// A line of directions with a coordinate, whose points can be drawn anew.
pub trait ShadowLine {
    /// Points of another draw, increasing, with the ends of the line.
    fn draw(&self, random: &mut dyn FnMut() -> f64) -> Vec<f64>;

    /// The directions between two points, over 0 to 1.
    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3;

    /// The coordinate of part `s` of the directions between two points.
    fn coordinate(&self, ends: [f64; 2], s: f64) -> f64;

    /// How far along them the light is.
    fn far(&self) -> f32;

    /// The intervals between borders at these coordinates, increasing.
    fn intervals(&self, borders: &[f64]) -> Intervals;
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

/// Where a shadow ends, or must end.
struct ShadowEnd {
    at: f64,
    /// The point that is hidden, up to which the shadow reaches at least.
    hidden: f64,
    /// The point that is not.
    free: f64,
    found: Option<OccluderEnd>,
}

impl ShadowEnd {
    /// The neighbours of the end among points, that which would be hidden first.
    fn neighbours(&self, points: &[f64]) -> Option<[f64; 2]> {
        let after = points.partition_point(|&p| p < self.at);
        let (above, below) = (*points.get(after)?, *points.get(after.checked_sub(1)?)?);
        Some(if self.hidden > self.free {
            [above, below]
        } else {
            [below, above]
        })
    }
}

/// A line on which the ends of shadows are looked for.
pub struct Shadows<'a, L> {
    pub scene: &'a SearchScene<'a>,
    pub point: &'a SurfacePoint,
    pub line: &'a L,
}

impl<L: ShadowLine> Shadows<'_, L> {
    /// The ends of all shadows between these points, of which is known whether they are open.
    /// `stream` is for other draws.
    pub fn edges(
        &self,
        points: &[f64],
        is_open: &[bool],
        stream: &Stream,
        counts: &mut Counts,
    ) -> Vec<ShadowEdge> {
        let changes = (0..is_open.len() - 1).filter(|&i| is_open[i] != is_open[i + 1]);
        let ends: Vec<ShadowEnd> = changes
            .map(|i| {
                let (hidden, free) = if is_open[i] { (i + 1, i) } else { (i, i + 1) };
                self.end(points[hidden], points[free], counts)
            })
            .collect();
        let weights = self.weights(&ends, stream, counts);
        let edges = ends.into_iter().zip(weights).filter_map(|(end, weight)| {
            let sign = if end.hidden < end.free { -1.0 } else { 1.0 };
            Some(ShadowEdge {
                at: end.at,
                jump: sign * weight,
                end: end.found?,
            })
        });
        edges.collect()
    }

    /// The end of the shadow that hides one point, on the way to one that is free.
    fn end(&self, hidden: f64, free: f64, counts: &mut Counts) -> ShadowEnd {
        let between = self.line.between([hidden, free]);
        let far = self.line.far();
        let found = follow_occluders(self.scene, self.point, &between, far, counts);
        counts.unresolved += found.is_none() as u64;
        let place = found.as_ref().map_or(0.5, |end| end.at);
        ShadowEnd {
            at: self.line.coordinate([hidden, free], place),
            hidden,
            free,
            found,
        }
    }

    /// What each end is to be weighed with.
    fn weights(&self, ends: &[ShadowEnd], stream: &Stream, counts: &mut Counts) -> Vec<f64> {
        let Some(first) = ends.first() else {
            return Vec::new();
        };
        let places: Vec<f64> = ends.iter().map(|end| end.at).collect();
        let intervals = self.line.intervals(&places);
        let known = intervals.shadow_weights(first.free < first.hidden);
        let weight = |(number, known): (usize, f64)| {
            let stream = stream.branch(Branch::ShadowEnd, [number as u32, 0, 0]);
            known + self.excess(ends, number, &stream, counts)
        };
        known.into_iter().enumerate().map(weight).collect()
    }

    /// Draws until an end is found again, less those until it would be found if there were no
    /// others than these.
    fn excess(
        &self,
        ends: &[ShadowEnd],
        number: usize,
        stream: &Stream,
        counts: &mut Counts,
    ) -> f64 {
        if ends[number].found.is_none() {
            return 0.0;
        }
        let mut dimension = 0;
        let mut random = || {
            dimension += 1;
            stream.uniform(dimension) as f64
        };
        let [mut found, mut expected] = [None; 2];
        for draw in 1..MOST_DRAWS {
            let points = self.line.draw(&mut random);
            if expected.is_none() && would_be_found(ends, number, &points) {
                expected = Some(draw);
            }
            if found.is_none() && self.is_found(&ends[number], &points, counts) {
                found = Some(draw);
            }
            if found.is_some() && expected.is_some() {
                break;
            }
        }
        let [found, expected] = [found, expected].map(|n| n.unwrap_or(MOST_DRAWS) as f64);
        found - expected
    }

    /// Whether an end would be found between these points.
    fn is_found(&self, end: &ShadowEnd, points: &[f64], counts: &mut Counts) -> bool {
        let Self { scene, point, line } = *self;
        let Some(neighbours @ [hidden, _]) = end.neighbours(points) else {
            return false;
        };
        let direction = line.between(neighbours);
        let is_free = |s: f64, counts: &mut Counts| {
            counts.probe += 1;
            point.first_hit(scene.view, direction(s), line.far()) == NO_TRIANGLE
        };
        if !is_free(1.0, counts) {
            return false;
        }
        // All is dark between the end and the point that was hidden.
        if (hidden - end.at).abs() <= (end.hidden - end.at).abs() {
            return true;
        }
        if is_free(0.0, counts) {
            return false;
        }
        let again = follow_occluders(scene, point, &direction, line.far(), counts);
        let gap = 2.0 * PROBE * (end.hidden - end.free).abs();
        again.is_some_and(|again| (line.coordinate(neighbours, again.at) - end.at).abs() <= gap)
    }
}

/// Whether an end would be found between these points if there were no others than `ends`.
fn would_be_found(ends: &[ShadowEnd], number: usize, points: &[f64]) -> bool {
    let end = &ends[number];
    let Some(neighbours) = end.neighbours(points) else {
        return false;
    };
    let [hidden, free] = neighbours.map(|at| ends.partition_point(|end| end.at < at));
    let is_hidden_after = end.hidden > end.free;
    // Hidden and open intervals take turns.
    hidden == number + is_hidden_after as usize && (free + hidden) % 2 == 1
}
