//! What the searches of other points would have found on a line ([`crate::boundary::inclusion`]).
//!
//! Nothing is traced for it: what is seen in each interval is known, and walks tell the rest.

use crate::boundary::inclusion::{Intervals, SearchCache, SearchResult};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::{HALVINGS, between};
use std::collections::BTreeMap;

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
    known: SearchCache,
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
                borders,
                steps: BTreeMap::new(),
            },
            known: SearchCache::new(),
        }
    }

    /// The probability of finding the border `at`, which has been found between the points at
    /// `ends`.
    pub fn inclusion_of_border(&mut self, at: f64, ends: [f64; 2]) -> f64 {
        let Self {
            intervals,
            searches,
            known,
        } = self;
        let border = searches.interval_of(at);
        if intervals.is_always_found(border) {
            return 1.0;
        }
        let pair = ends.map(|end| searches.interval_of(end));
        let mut search = |pair| searches.between(pair);
        let reach = known.entry(pair).or_insert_with(|| search(pair));
        reach.borders.push(border);
        intervals.inclusion_of_border(border, known, &mut search)
    }

    /// The probability of finding an edge within what is seen at a coordinate.
    pub fn inclusion_of_ridge(&mut self, at: f64) -> f64 {
        let Self {
            intervals,
            searches,
            known,
        } = self;
        let interval = searches.interval_of(at);
        intervals.inclusion_within(interval, known, &mut |pair| searches.between(pair))
    }
}

/// How a search goes on between two intervals.
#[derive(Clone, Copy)]
enum Step {
    /// It finds nothing.
    Ends,
    /// It finds the borders between these two intervals, and searches before and after them.
    Finds([usize; 2]),
    /// It looks at what is seen in this one, and searches both halves.
    Halves(usize),
}

/// What searches between points in these intervals would find.
struct Searches<'a, L> {
    scene: &'a SearchScene<'a>,
    line: &'a L,
    borders: Vec<Border>,
    /// By the intervals between which they are made: searches have most of them in common.
    steps: BTreeMap<[usize; 2], Step>,
}

impl<L: RayLine> Searches<'_, L> {
    /// The interval in which a coordinate lies.
    fn interval_of(&self, at: f64) -> usize {
        self.borders.partition_point(|b| b.at < at)
    }

    fn between(&mut self, pair: [usize; 2]) -> SearchResult {
        let mut reach = SearchResult::default();
        self.look(pair, L::ROUNDS, HALVINGS, &mut reach);
        reach
    }

    /// As a search for silhouettes between points in two intervals goes, in the rounds and with the
    /// halvings that are left.
    fn look(&mut self, [j, k]: [usize; 2], rounds: u32, halvings: u32, reach: &mut SearchResult) {
        if k <= j || rounds == 0 {
            return;
        }
        if k == j + 1 {
            reach.borders.push(j);
            return;
        }
        let step = match self.steps.get(&[j, k]) {
            Some(&step) => step,
            None => {
                let step = self.step([j, k]);
                self.steps.insert([j, k], step);
                step
            }
        };
        match step {
            Step::Ends => {}
            Step::Finds([before, after]) => {
                reach.borders.extend(before..after);
                self.look([j, before], rounds - 1, HALVINGS, reach);
                self.look([after, k], rounds - 1, HALVINGS, reach);
            }
            Step::Halves(_) if halvings == 0 => {}
            Step::Halves(middle) => {
                reach.intervals.push(middle);
                self.look([j, middle], rounds, halvings - 1, reach);
                self.look([middle, k], rounds, halvings - 1, reach);
            }
        }
    }

    /// The first step between two intervals that are not neighbours.
    fn step(&self, [j, k]: [usize; 2]) -> Step {
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
                Step::Finds(sides.map(|p| self.interval_of(p)))
            }
            Err(_) => Step::Halves(self.interval_of(0.5 * (from + to))),
        }
    }
}
