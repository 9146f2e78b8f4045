//! How likely the ends of shadows are to be found on a line on which is seen only whether a light is hidden.
//!
//! Points are put on a line at random, and between a point that is hidden and a neighbour that is not, the end of the shadow that
//! hides the first is found. If there were no other borders on the line than those that were found, the chance of that would be known
//! (`super::runs`). But another shadow may be so thin that no point met it. Draws until the end is found again, N, are 1/P on
//! average, whatever is on the line; draws until it would be found if nothing else were there, M, are 1/P′ on average, P′
//! being the chance that is known. So 1/P′ + N − M is 1/P on average, and with the same draws for both it is 1/P′ and
//! has no noise at all unless something else is there.

use super::occluders::{PROBE, ShadowEdge, SurfacePoint, follow_occluders};
use super::random::Stream;
use super::runs::Runs;
use super::tracer::{Counts, Tracer};
use crate::trace::geometry::NO_TRIANGLE;
use crate::warp::adjacency::Adjacency;
use glam::DVec3;

/// No end stands for more than this.
const MOST_DRAWS: u32 = 1000;

/// A line of directions with a coordinate, whose points can be drawn anew.
pub(super) trait ShadowLine {
    /// Points of another draw, increasing, with the ends of the line.
    fn draw(&self, random: &mut dyn FnMut() -> f64) -> Vec<f64>;

    /// The directions between two points, over 0 to 1.
    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3;

    /// The coordinate of part `s` of the directions between two points.
    fn coordinate(&self, ends: [f64; 2], s: f64) -> f64;

    /// How far along them the light is.
    fn far(&self) -> f32;
}

/// Where a shadow ends, or must end.
pub(super) struct ShadowEnd {
    pub at: f64,
    /// The point that is hidden, up to which the shadow reaches at least.
    pub hidden: f64,
    /// The point that is not.
    pub free: f64,
    pub is_found: bool,
}

impl ShadowEnd {
    /// Of an edge that was found between the directions at these points of a line, at this coordinate.
    pub fn of_edge(edge: &ShadowEdge, points: &[f64], at: f64) -> Self {
        Self {
            at,
            hidden: points[edge.hidden],
            free: points[edge.free],
            is_found: edge.boundary.is_some(),
        }
    }

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

/// The line on which ends were found.
pub(super) struct Shadows<'a, L> {
    pub tracer: &'a Tracer<'a>,
    pub adjacency: &'a Adjacency,
    pub point: &'a SurfacePoint,
    pub line: &'a L,
    /// All ends, increasing.
    pub ends: &'a [ShadowEnd],
}

impl<L: ShadowLine> Shadows<'_, L> {
    /// What each end is to be weighed with; `runs` are those between them.
    pub fn weights(&self, runs: &Runs, stream: &Stream, counts: &mut Counts) -> Vec<f64> {
        let Some(first) = self.ends.first() else {
            return Vec::new();
        };
        let known = runs.weights_of_shadows(first.free < first.hidden);
        let weight = |(number, known): (usize, f64)| {
            let stream = stream.branch([1 + number as u32, 0]);
            known + self.excess(number, &stream, counts)
        };
        known.into_iter().enumerate().map(weight).collect()
    }

    /// Draws until an end is found again, less those until it would be found if there were no others than these.
    fn excess(&self, number: usize, stream: &Stream, counts: &mut Counts) -> f64 {
        if !self.ends[number].is_found {
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
            if expected.is_none() && self.would_be_found(number, &points) {
                expected = Some(draw);
            }
            if found.is_none() && self.is_found(number, &points, counts) {
                found = Some(draw);
            }
            if found.is_some() && expected.is_some() {
                break;
            }
        }
        let [found, expected] = [found, expected].map(|n| n.unwrap_or(MOST_DRAWS) as f64);
        found - expected
    }

    fn would_be_found(&self, number: usize, points: &[f64]) -> bool {
        let Some(neighbours) = self.ends[number].neighbours(points) else {
            return false;
        };
        let [hidden, free] = neighbours.map(|at| self.ends.partition_point(|end| end.at < at));
        let is_hidden_after = self.ends[number].hidden > self.ends[number].free;
        // Hidden and open runs take turns.
        hidden == number + is_hidden_after as usize && (free + hidden) % 2 == 1
    }

    fn is_found(&self, number: usize, points: &[f64], counts: &mut Counts) -> bool {
        let Self {
            tracer,
            adjacency,
            point,
            line,
            ends,
        } = *self;
        let end = &ends[number];
        let Some(neighbours @ [hidden, _]) = end.neighbours(points) else {
            return false;
        };
        let direction = line.between(neighbours);
        let is_free = |s: f64, counts: &mut Counts| {
            point.first_hit(tracer, direction(s), line.far(), counts) == NO_TRIANGLE
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
        let whole = [0.0, 1.0];
        let again = follow_occluders(
            tracer,
            adjacency,
            point,
            &direction,
            whole,
            line.far(),
            counts,
        );
        let gap = 2.0 * PROBE * (end.hidden - end.free).abs();
        again.is_some_and(|again| (line.coordinate(neighbours, again.at) - end.at).abs() <= gap)
    }
}
