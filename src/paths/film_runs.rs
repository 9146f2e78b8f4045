//! Things on the film that are thinner than the lattice.
//!
//! Between two silhouettes on a line of the lattice lies a *run*. The lattice is shifted by a random vector, so a point
//! of it falls into a run that is shorter than its step with the chance length/step, and if none does, neither silhouette is
//! found: the ends of the cell see what is on either side. When one does, both stand for all that are missed.

use super::film_cells::{LatticeCells, LatticeLine, Met};
use super::tracer::Counts;
use std::collections::BTreeSet;

/// Shorter runs than this part of a step are weighed as if they were this long.
const SHORTEST_RUN: f64 = 1e-3;
/// One silhouette, found in two cells, lies within this part of a step in both.
const ROUNDING: f64 = 1e-6;

/// Weighs what was met in runs shorter than a step by one over the chance of meeting them. Of the cells in `skipped` it is
/// not known yet where their silhouettes are.
pub(super) fn weigh_short_runs(
    film: &LatticeCells,
    met: &mut [Met],
    skipped: &BTreeSet<(LatticeLine, i64)>,
    counts: &mut Counts,
) {
    let order = |a: &Met, b: &Met| a.line.cmp(&b.line).then(a.steps.total_cmp(&b.steps));
    met.sort_by(order);
    for met in met.chunk_by_mut(|a, b| a.line == b.line) {
        let silhouettes = met.iter().filter(|met| met.is_silhouette);
        let runs = Runs {
            film,
            skipped,
            line: met[0].line,
            silhouettes: silhouettes.map(|met| met.steps).collect(),
        };
        let mut before = 0;
        for met in met {
            let at = before;
            before += met.is_silhouette as usize;
            let Some(crossing) = &mut met.crossing else {
                continue;
            };
            // Its own run, or those on either side of it.
            let ends = [
                runs.end_before(at, met.steps, counts),
                met.is_silhouette.then_some(met.steps),
                runs.end_after(before, met.steps, counts),
            ];
            let ends: Vec<f64> = ends.into_iter().flatten().collect();
            let weights = ends
                .windows(2)
                .map(|run| runs.weight([run[0], run[1]], counts));
            let weight = weights.fold(1.0, f64::max);
            crossing.jump = crossing.jump.map(|jump| jump * weight as f32);
        }
    }
}

/// The runs of one line.
struct Runs<'a> {
    film: &'a LatticeCells<'a>,
    skipped: &'a BTreeSet<(LatticeLine, i64)>,
    line: LatticeLine,
    /// In steps from the first point, in increasing order.
    silhouettes: Vec<f64>,
}

impl Runs<'_> {
    /// The silhouette before `steps`, before which there are `count`, if it is nearer than two cells.
    fn end_before(&self, count: usize, steps: f64, counts: &mut Counts) -> Option<f64> {
        let previous = steps.floor() - 1.0;
        let known = self.silhouettes[..count].last().copied();
        known
            .filter(|known| known.floor() >= previous)
            .or_else(|| self.looked_for(previous as i64, counts).reduce(f64::max))
    }

    /// The silhouette after `steps`, up to which there are `count`, if it is nearer than two cells.
    fn end_after(&self, count: usize, steps: f64, counts: &mut Counts) -> Option<f64> {
        let next = steps.floor() + 1.0;
        let known = self.silhouettes.get(count).copied();
        known
            .filter(|known| known.floor() <= next)
            .or_else(|| self.looked_for(next as i64, counts).reduce(f64::min))
    }

    /// The silhouettes in a cell that has not been searched.
    fn looked_for(&self, cell: i64, counts: &mut Counts) -> impl Iterator<Item = f64> {
        let cells = self.film.tile.points[self.line.axis] as i64 - 1;
        let is_known = (0..cells).contains(&cell) && !self.skipped.contains(&(self.line, cell));
        let found = if is_known {
            Vec::new()
        } else {
            self.film
                .cell(self.line, cell, 1, counts)
                .all_crossings(0.0, counts)
        };
        let silhouettes = found.into_iter().filter(|found| found.is_silhouette);
        silhouettes.map(|found| self.film.steps(self.line, found.at))
    }

    /// One over the chance of meeting the run between two silhouettes; 1 if it would have been found without a point in it,
    /// because what is seen on either side could not be explained otherwise, or because it hides what would.
    fn weight(&self, [from, to]: [f64; 2], counts: &mut Counts) -> f64 {
        let [first, last] = [from, to].map(f64::floor);
        if first == last || to - from >= 1.0 {
            return 1.0;
        }
        let around = self.film.cell(self.line, first as i64, 2, counts);
        let is_found_anyway = match around.crossings(0.0) {
            Err(_) => true,
            Ok([Some(silhouette), _]) => {
                let at = self.film.steps(self.line, silhouette.at);
                (from - ROUNDING..=to + ROUNDING).contains(&at)
            }
            Ok([None, _]) => false,
        };
        if is_found_anyway {
            1.0
        } else {
            1.0 / (to - from).max(SHORTEST_RUN)
        }
    }
}
