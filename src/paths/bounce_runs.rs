//! What the searches of other points would have found on a line among surfaces ([`super::runs`]).
//!
//! Nothing is traced for it: what is seen in each run is known, and walks tell the rest.

use super::bounce_lines::Line;
use super::occluders::{PROBE, SurfacePoint};
use super::runs::{Known, Reach, Runs};
use crate::trace::geometry::Geometry;
use crate::warp::adjacency::Adjacency;
use crate::warp::resolve::between;
use crate::warp::walk::Arc;

/// One silhouette has the same coordinate on all arcs that it is found on, up to this angle in radians.
const ROUNDING: f64 = 1e-6;
/// Silhouettes and halvings, one within another, that a search is followed through.
const DEPTH: u32 = 16;

/// Where something else begins to be seen on a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Border {
    pub psi: f64,
    /// The ψ on either side of it, and the triangles that are seen there.
    pub beside: [f64; 2],
    pub seen: [u32; 2],
}

/// The runs of a line, and what is seen in them.
pub(super) struct LineRuns<'a> {
    geometry: &'a Geometry,
    adjacency: &'a Adjacency,
    line: &'a Line,
    point: &'a SurfacePoint,
    borders: Vec<Border>,
    runs: Runs,
    known: Known,
}

impl<'a> LineRuns<'a> {
    /// `borders` in any order.
    pub fn new(
        geometry: &'a Geometry,
        adjacency: &'a Adjacency,
        line: &'a Line,
        point: &'a SurfacePoint,
        mut borders: Vec<Border>,
    ) -> Self {
        borders.sort_by(|a, b| a.psi.total_cmp(&b.psi));
        let psi: Vec<f64> = borders.iter().map(|b| b.psi).collect();
        Self {
            geometry,
            adjacency,
            line,
            point,
            runs: line.runs(&psi),
            borders,
            known: Known::new(),
        }
    }

    /// The run in which a ψ lies.
    fn run_of(&self, psi: f64) -> usize {
        self.borders.partition_point(|b| b.psi < psi)
    }

    /// The probability of finding the silhouette at `psi`, which has been found between the points at `ends`.
    pub fn chance_of_silhouette(&mut self, psi: f64, ends: [f64; 2]) -> f64 {
        let border = self.run_of(psi);
        let pair = ends.map(|psi| self.run_of(psi));
        let mut known = std::mem::take(&mut self.known);
        let reach = known.entry(pair).or_insert_with(|| self.search(pair));
        reach.borders.insert(border);
        let chance = self
            .runs
            .chance_of_border(border, &mut known, &mut |pair| self.search(pair));
        self.known = known;
        chance
    }

    /// The probability of finding an edge within what is seen at `psi`.
    pub fn chance_of_ridge(&mut self, psi: f64) -> f64 {
        let run = self.run_of(psi);
        let mut known = std::mem::take(&mut self.known);
        let chance = self
            .runs
            .chance_of_run(run, &mut known, &mut |pair| self.search(pair));
        self.known = known;
        chance
    }

    fn search(&self, pair: [usize; 2]) -> Reach {
        let mut reach = Reach::default();
        self.look(pair, DEPTH, &mut reach);
        reach
    }

    /// As the search for silhouettes between points in two runs goes (`super::bounce_surfaces`).
    fn look(&self, [j, k]: [usize; 2], depth: u32, reach: &mut Reach) {
        if k <= j || depth == 0 {
            return;
        }
        if k == j + 1 {
            reach.borders.insert(j);
            return;
        }
        let (first, last) = (self.borders[j], self.borders[k - 1]);
        let (from, to) = (first.beside[0], last.beside[1]);
        let ends = [first.seen[0], last.seen[1]];
        if from >= to || ends[0] == ends[1] {
            return;
        }
        let [a, b] = [from, to].map(|psi| self.line.direction(psi));
        let arc = Arc {
            origin: self.point.leave(a + b).as_dvec3(),
            a,
            b,
        };
        match between(self.geometry, self.adjacency, &arc, ends, 0.0, PROBE) {
            Ok([None, _]) => {}
            Ok([Some(crossing), _]) => {
                let psi = self.line.psi_of(arc.direction(crossing.s));
                let [before, after] = [psi - ROUNDING, psi + ROUNDING].map(|p| self.run_of(p));
                reach.borders.extend(before..after);
                self.look([j, before], depth - 1, reach);
                self.look([after, k], depth - 1, reach);
            }
            Err(_) => {
                let middle = self.run_of(0.5 * (from + to));
                reach.runs.insert(middle);
                self.look([j, middle], depth - 1, reach);
                self.look([middle, k], depth - 1, reach);
            }
        }
    }
}
