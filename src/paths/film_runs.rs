//! Things on the film that are thinner than the lattice ([`super::runs`]).

use super::film_cell::{Borders, LatticeLine};
use super::film_cells::{self, LatticeCells, Met};
use super::line_runs::{LineRuns, RayLine};
use super::runs::Runs;
use super::tracer::Counts;
use crate::warp::walk::Arc;
use std::collections::BTreeSet;

/// Weighs what was met by one over the chance of meeting it. What lies in the cells in `skipped` is not among `borders` yet.
pub(super) fn weigh(
    film: &LatticeCells,
    met: &mut [Met],
    mut borders: Borders,
    skipped: &BTreeSet<(LatticeLine, i64)>,
    counts: &mut Counts,
) {
    met.sort_by(|a, b| a.line.cmp(&b.line).then(a.steps.total_cmp(&b.steps)));
    for met in met.chunk_by_mut(|a, b| a.line == b.line) {
        let line = met[0].line;
        let cells = film.tile.points[line.axis] as i64 - 1;
        // What is further away than a step does not matter.
        let cell_of = |met: &Met| met.steps.floor() as i64;
        let near: BTreeSet<i64> = met
            .iter()
            .flat_map(|met| cell_of(met) - 1..=cell_of(met) + 1)
            .collect();
        for cell in near {
            if !(0..cells).contains(&cell) || skipped.contains(&(line, cell)) {
                film.find_borders(line, cell, &mut borders, counts);
            }
        }
        let on_film = OnFilm { film, line };
        let mut runs = LineRuns::new(
            film.tracer.geometry,
            film.adjacency,
            &on_film,
            borders.remove(&line).unwrap_or_default(),
            Runs::new,
        );
        for met in met {
            let chance = if met.is_silhouette {
                let first = met.steps.floor();
                runs.chance_of_border(met.steps, [first, first + 1.0])
            } else {
                runs.chance_of_ridge(met.steps)
            };
            let jump = &mut met.crossing.jump;
            *jump = jump.map(|jump| jump / chance as f32);
        }
    }
}

/// A line of the lattice, in steps from its first point.
struct OnFilm<'a> {
    film: &'a LatticeCells<'a>,
    line: LatticeLine,
}

impl RayLine for OnFilm<'_> {
    const ROUNDS: u32 = film_cells::ROUNDS;

    fn arc(&self, [from, to]: [f64; 2]) -> Arc {
        Arc {
            origin: self.film.tracer.camera.origin.as_dvec3(),
            a: self.film.direction(self.line, from),
            b: self.film.direction(self.line, to),
        }
    }

    fn coordinate(&self, _: &Arc, [from, to]: [f64; 2], s: f64) -> f64 {
        // Directions are linear in film positions.
        from + (to - from) * s
    }
}
