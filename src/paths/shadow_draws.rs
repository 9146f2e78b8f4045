//! How likely the end of a shadow is to be found on a line on which is seen only whether a light is hidden.
//!
//! Points are put on a line at random, and between a point that is hidden and a neighbour that is not, the end of the shadow that
//! hides the first is found. What else lies on the line nobody knows: another shadow may be so thin that no point
//! met it, and in its place the neighbour of another draw may stand. So the chance P of finding that end is not to be had,
//! but one over it is: draws until it is found again are 1/P on average. Ends that every draw finds need a single one, and as
//! an end is found with chance P in the first place, one draw is what each costs on average.

use super::occluders::{PROBE, SurfacePoint, follow_occluders};
use super::random::Stream;
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

/// Where a shadow ends.
pub(super) struct ShadowEnd {
    pub at: f64,
    /// The point that is hidden, up to which the shadow reaches at least.
    pub hidden: f64,
    /// The point that is not.
    pub free: f64,
}

/// The number of draws until an end is found again.
pub(super) fn draws_until_found(
    tracer: &Tracer,
    adjacency: &Adjacency,
    point: &SurfacePoint,
    line: &impl ShadowLine,
    end: &ShadowEnd,
    stream: &Stream,
    counts: &mut Counts,
) -> f64 {
    let is_hidden_above = end.hidden > end.at;
    let gap = 2.0 * PROBE * (end.hidden - end.free).abs();
    let mut dimension = 0;
    let mut random = || {
        dimension += 1;
        stream.uniform(dimension) as f64
    };
    let mut is_found = |points: &[f64]| {
        let after = points.partition_point(|&p| p < end.at);
        let (Some(&above), Some(&below)) = (points.get(after), points.get(after.wrapping_sub(1)))
        else {
            return false;
        };
        let (hidden, free) = if is_hidden_above {
            (above, below)
        } else {
            (below, above)
        };
        let ends = [hidden, free];
        let direction = line.between(ends);
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
        let again = follow_occluders(
            tracer,
            adjacency,
            point,
            &direction,
            [0.0, 1.0],
            line.far(),
            counts,
        );
        again.is_some_and(|again| (line.coordinate(ends, again.at) - end.at).abs() <= gap)
    };
    let found = (1..MOST_DRAWS).find(|_| is_found(&line.draw(&mut random)));
    found.unwrap_or(MOST_DRAWS) as f64
}
