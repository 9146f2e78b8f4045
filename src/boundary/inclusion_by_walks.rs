//! What the searches of other points would have found on a line ([`crate::boundary::inclusion`]).
//!
//! Nothing is traced for it: what is seen in each interval is known, and walks tell the rest.

use crate::boundary::inclusion::{Intervals, SearchCache, SearchResult};
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
    scene: &'a SearchScene<'a>,
    line: &'a L,
    borders: Vec<Border>,
    intervals: Intervals,
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
            scene,
            line,
            intervals: intervals(borders.iter().map(|b| b.at).collect()),
            borders,
            known: SearchCache::new(),
        }
    }

    /// The interval in which a coordinate lies.
    fn run_of(&self, at: f64) -> usize {
        self.borders.partition_point(|b| b.at < at)
    }

    /// The probability of finding the border `at`, which has been found between the points at
    /// `ends`.
    pub fn inclusion_of_border(&mut self, at: f64, ends: [f64; 2]) -> f64 {
        let border = self.run_of(at);
        if self.intervals.is_always_found(border) {
            return 1.0;
        }
        let pair = ends.map(|end| self.run_of(end));
        let mut known = std::mem::take(&mut self.known);
        let mut search = |pair| self.search(pair);
        let reach = known.entry(pair).or_insert_with(|| search(pair));
        reach.borders.insert(border);
        let chance = self
            .intervals
            .inclusion_of_border(border, &mut known, &mut search);
        self.known = known;
        chance
    }

    /// The probability of finding an edge within what is seen at a coordinate.
    pub fn inclusion_of_ridge(&mut self, at: f64) -> f64 {
        let mut known = std::mem::take(&mut self.known);
        let mut search = |pair| self.search(pair);
        let chance = self
            .intervals
            .inclusion_within(self.run_of(at), &mut known, &mut search);
        self.known = known;
        chance
    }

    fn search(&self, pair: [usize; 2]) -> SearchResult {
        let mut reach = SearchResult::default();
        self.look(pair, L::ROUNDS, HALVINGS, &mut reach);
        reach
    }

    /// As a search for silhouettes between points in two intervals goes, in the rounds and with the
    /// halvings that are left.
    fn look(&self, [j, k]: [usize; 2], rounds: u32, halvings: u32, reach: &mut SearchResult) {
        if k <= j || rounds == 0 {
            return;
        }
        if k == j + 1 {
            reach.borders.insert(j);
            return;
        }
        let (first, last) = (self.borders[j], self.borders[k - 1]);
        let ends @ [from, to] = [first.beside[0], last.beside[1]];
        let seen = [first.seen[0], last.seen[1]];
        if from >= to || seen[0] == seen[1] {
            return;
        }
        let arc = self.line.arc(ends);
        let (geometry, adjacency) = (self.scene.view.geometry, self.scene.adjacency);
        match between(geometry, adjacency, &arc, seen, None, 0.0) {
            Ok([None, _]) => {}
            Ok([Some(crossing), _]) => {
                let at = self.line.coordinate(&arc, ends, crossing.s);
                let [before, after] = [at - L::ROUNDING, at + L::ROUNDING].map(|p| self.run_of(p));
                reach.borders.extend(before..after);
                self.look([j, before], rounds - 1, HALVINGS, reach);
                self.look([after, k], rounds - 1, HALVINGS, reach);
            }
            Err(_) if halvings == 0 => {}
            Err(_) => {
                let middle = self.run_of(0.5 * (from + to));
                reach.intervals.insert(middle);
                self.look([j, middle], rounds, halvings - 1, reach);
                self.look([middle, k], rounds, halvings - 1, reach);
            }
        }
    }
}
