//! What the searches of other points would have found on a line ([`crate::boundary::inclusion`]).
//!
//! Nothing is traced for it: what is seen in each interval is known, and walks tell the rest.

use crate::boundary::inclusion::Intervals;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::{HALVINGS, between};

/// A line of rays from one point, with a coordinate.
pub trait RayLine {
    /// One silhouette has the same coordinate, whatever the arc that it is found on, up to this.
    const ROUNDING: f64 = 1e-6;

    /// Silhouettes behind one another that are looked for between two points.
    const ROUNDS: u32;

    /// The rays between two coordinates.
    fn arc(&self, ends: [f64; 2]) -> Arc;

    /// The coordinate of parameter `s` of `arc`, whose ends are these.
    fn coordinate(&self, arc: &Arc, ends: [f64; 2], s: f64) -> f64;
}

/// Where something else begins to be seen on a line.
#[derive(Clone, Copy, Debug)]
pub struct Border {
    /// Its coordinate.
    pub at: f64,
    /// Those on either side of it, and the triangles that are seen there.
    pub beside: [f64; 2],
    pub seen: [u32; 2],
}

/// The intervals of a line, and what is seen in them.
pub struct InclusionByWalks<'a, L> {
    intervals: Intervals,
    searches: Searches<'a, L>,
}

impl<'a, L: RayLine> InclusionByWalks<'a, L> {
    /// `borders` in any order, of which `intervals` makes intervals.
    pub fn new(
        scene: &'a SearchScene<'a>,
        line: &'a L,
        mut borders: Vec<Border>,
        intervals: impl FnOnce(Vec<f64>) -> Intervals,
    ) -> Self {
        borders.sort_by(|a, b| a.at.total_cmp(&b.at));
        Self {
            intervals: intervals(borders.iter().map(|b| b.at).collect()),
            searches: Searches {
                scene,
                line,
                steps: vec![Vec::new(); borders.len()],
                borders,
            },
        }
    }

    /// The probability of finding the border `at`, which has been found between the points at
    /// `ends`.
    pub fn inclusion_of_border(&mut self, at: f64, ends: [f64; 2]) -> f64 {
        let searches = &mut self.searches;
        let border = searches.interval_of(at);
        let found_by = ends.map(|end| searches.interval_of(end));
        self.intervals.inclusion_of_border(border, |pair| {
            pair == found_by || searches.finds(border, pair)
        })
    }

    /// The probability of finding an edge within what is seen at a coordinate.
    pub fn inclusion_of_ridge(&mut self, at: f64) -> f64 {
        let searches = &mut self.searches;
        let interval = searches.interval_of(at);
        self.intervals
            .inclusion_within(interval, |pair| searches.look_within(interval, pair))
    }
}

/// How a search goes on between two intervals.
#[derive(Clone, Copy)]
enum Step {
    /// That has not been asked yet.
    Unknown,
    /// It finds nothing.
    Ends,
    /// It finds the borders between these two intervals, and searches before and after them.
    Finds([u32; 2]),
    /// It looks at what is seen in this one, and searches both halves.
    Halves(u32),
}

/// How far a search still goes: silhouettes behind one another, and halves of what is not
/// understood.
struct Left {
    rounds: u32,
    halvings: u32,
}

impl Left {
    fn of<L: RayLine>() -> Self {
        Self {
            rounds: L::ROUNDS,
            halvings: HALVINGS,
        }
    }
}

/// What searches between points in these intervals would find.
struct Searches<'a, L> {
    scene: &'a SearchScene<'a>,
    line: &'a L,
    borders: Vec<Border>,
    /// Of searches from each interval but the last, to those that are not its neighbours: searches
    /// have most of their steps in common.
    steps: Vec<Vec<Step>>,
}

impl<L: RayLine> Searches<'_, L> {
    /// The interval in which a coordinate lies.
    fn interval_of(&self, at: f64) -> usize {
        self.borders.partition_point(|b| b.at < at)
    }

    /// Whether searches between two intervals, one on each side of a border, find it.
    fn finds(&mut self, border: usize, mut pair: [usize; 2]) -> bool {
        let mut left = Left::of::<L>();
        while left.rounds > 0 {
            let [j, k] = pair;
            if k == j + 1 {
                return true;
            }
            let Some((_, [before, after])) = self.parts(pair, &mut left) else {
                return false;
            };
            if border < before {
                pair = [j, before];
            } else if border >= after {
                pair = [after, k];
            } else {
                return true;
            }
            if pair[1] <= pair[0] || pair == [j, k] {
                return false;
            }
        }
        false
    }

    /// Whether searches between two intervals, one on each side of another, look at what is seen in
    /// that.
    fn look_within(&mut self, interval: usize, mut pair: [usize; 2]) -> bool {
        let mut left = Left::of::<L>();
        while left.rounds > 0 && pair[0] < interval && interval < pair[1] {
            let Some((looked_at, [before, after])) = self.parts(pair, &mut left) else {
                return false;
            };
            if looked_at == Some(interval) {
                return true;
            }
            pair = if interval < before {
                [pair[0], before]
            } else {
                [after, pair[1]]
            };
        }
        false
    }

    /// Where searches go on, before the first and after the second interval, and in which they
    /// looked at what is seen; `None` if they end.
    fn parts(&mut self, pair: [usize; 2], left: &mut Left) -> Option<(Option<usize>, [usize; 2])> {
        match self.step(pair) {
            Step::Unknown | Step::Ends => None,
            Step::Finds(found) => {
                left.rounds -= 1;
                left.halvings = HALVINGS;
                Some((None, found.map(|interval| interval as usize)))
            }
            Step::Halves(_) if left.halvings == 0 => None,
            Step::Halves(middle) => {
                left.halvings -= 1;
                let middle = middle as usize;
                Some((Some(middle), [middle; 2]))
            }
        }
    }

    /// The first step of searches between two intervals that are not neighbours.
    fn step(&mut self, [j, k]: [usize; 2]) -> Step {
        if self.steps[j].is_empty() {
            self.steps[j] = vec![Step::Unknown; self.borders.len() - 1 - j];
        }
        let number = k - j - 2;
        if let Step::Unknown = self.steps[j][number] {
            self.steps[j][number] = self.walk([j, k]);
        }
        self.steps[j][number]
    }

    fn walk(&self, [j, k]: [usize; 2]) -> Step {
        let (first, last) = (self.borders[j], self.borders[k - 1]);
        let ends @ [from, to] = [first.beside[0], last.beside[1]];
        let seen = [first.seen[0], last.seen[1]];
        if from >= to || seen[0] == seen[1] {
            return Step::Ends;
        }
        let arc = self.line.arc(ends);
        let (geometry, adjacency) = (self.scene.view.geometry, self.scene.adjacency);
        match between(geometry, adjacency, &arc, seen, None, 0.0) {
            Ok([None, _]) => Step::Ends,
            Ok([Some(crossing), _]) => {
                let at = self.line.coordinate(&arc, ends, crossing.s);
                let sides = [at - L::ROUNDING, at + L::ROUNDING];
                Step::Finds(sides.map(|p| self.interval_of(p) as u32))
            }
            Err(_) => Step::Halves(self.interval_of(0.5 * (from + to)) as u32),
        }
    }
}
