//! Things on the film that are thinner than the lattice (`boundary::inclusion`).

use super::cell::{FilmCell, LatticeCells, LatticeLine};
use crate::boundary::cells::line_search::{Cell, LineSearch, Met};
use crate::boundary::inclusion::Intervals;
use crate::boundary::inclusion_by_walks::{InclusionByWalks, RayLine};
use crate::discontinuity::arc::Arc;
use std::collections::BTreeSet;

/// Silhouettes behind one another that are looked for in one cell.
pub const ROUNDS: u32 = 4;

/// The chances of meeting what was met, which is put in order. What lies in the cells in `skipped`
/// is not among the borders yet.
pub fn chances<'a>(
    cells: &LatticeCells<'a>,
    search: &mut LineSearch<FilmCell<'a>>,
    skipped: &BTreeSet<(LatticeLine, i64)>,
) -> Vec<f64> {
    let steps = |met: &Met<FilmCell>| met.at.coordinate();
    let mut chances = Vec::with_capacity(search.met.len());
    let mut all = std::mem::take(&mut search.met);
    all.sort_by(|a, b| {
        let by_line = a.at.cell.line().cmp(&b.at.cell.line());
        by_line.then(steps(a).total_cmp(&steps(b)))
    });
    for met in all.chunk_by(|a, b| a.at.cell.line() == b.at.cell.line()) {
        let line = met[0].at.cell.line();
        let count = cells.film.tile.points[line.axis] as i64 - 1;
        // What is further away than a step does not matter.
        let cell_of = |met: &Met<FilmCell>| steps(met).floor() as i64;
        let near: BTreeSet<i64> = met
            .iter()
            .flat_map(|met| cell_of(met) - 1..=cell_of(met) + 1)
            .collect();
        for at in near {
            if !(0..count).contains(&at) || skipped.contains(&(line, at)) {
                let cell = cells.cell(line, at, search.counts);
                search.add_borders(&cell, ROUNDS);
            }
        }
        let on_film = OnFilm { cells, line };
        let mut intervals = InclusionByWalks::new(
            cells.scene,
            &on_film,
            search.borders.remove(&line).unwrap_or_default(),
            Intervals::new,
        );
        chances.extend(met.iter().map(|met| {
            let steps = steps(met);
            if met.at.crossing.is_silhouette() {
                let first = steps.floor();
                intervals.inclusion_of_border(steps, [first, first + 1.0])
            } else {
                intervals.inclusion_of_ridge(steps)
            }
        }));
    }
    search.met = all;
    chances
}

/// A line of the lattice, in steps from its first point.
struct OnFilm<'a> {
    cells: &'a LatticeCells<'a>,
    line: LatticeLine,
}

impl RayLine for OnFilm<'_> {
    const ROUNDS: u32 = ROUNDS;

    fn arc(&self, [from, to]: [f64; 2]) -> Arc {
        Arc {
            origin: self.cells.scene.view.camera.eye(),
            a: self.cells.direction(self.line, from),
            b: self.cells.direction(self.line, to),
        }
    }

    fn coordinate(&self, _: &Arc, [from, to]: [f64; 2], s: f64) -> f64 {
        // Directions are linear in film positions.
        from + (to - from) * s
    }
}
