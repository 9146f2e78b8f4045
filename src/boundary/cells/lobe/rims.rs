//! Where the beams of lights end on what a vertex sees along a line over its lobe.

use super::cell::LobeCell;
use super::line::Line;
use super::met::{Met, SMALLEST_CHANCE};
use crate::boundary::cells::delta::follow::surface_end;
use crate::boundary::cells::delta::rim::{Rim, on_surface};
use crate::boundary::occlusion::PROBE;
use crate::boundary::search_scene::SearchScene;
use crate::paths::counts::Counts;
use crate::trace::geometry::NO_TRIANGLE;

/// Those that move, in the cells of a line.
pub fn find(scene: &SearchScene, line: &Line, cells: &[LobeCell], counts: &mut Counts) -> Vec<Met> {
    let rims = Rim::all(scene.view.delta_lights);
    let mut met = Vec::new();
    if rims.is_empty() {
        return met;
    }
    for number in 0..cells.len() {
        let search = RimSearch {
            scene,
            line,
            cells,
            rims: &rims,
        };
        if !search.starting_at(number, false, &mut met, counts) {
            search.starting_at(number, true, &mut met, counts);
        }
    }
    met
}

struct RimSearch<'a> {
    scene: &'a SearchScene<'a>,
    line: &'a Line,
    cells: &'a [LobeCell<'a>],
    rims: &'a [(usize, Rim)],
}

impl RimSearch<'_> {
    /// Looks for them on what is seen at one end of a cell. Says whether the other sees it, too.
    fn starting_at(
        &self,
        number: usize,
        is_reversed: bool,
        met: &mut Vec<Met>,
        counts: &mut Counts,
    ) -> bool {
        let rays = self.cells[number].rays(is_reversed);
        let arc = rays.arc;
        // Points beyond an end of the line were put there.
        if arc.a == arc.b {
            return true;
        }
        if rays.seen[0] == NO_TRIANGLE {
            return rays.seen[1] == NO_TRIANGLE;
        }
        let drifts = |_| self.cells[number].lane_moves;
        let (end, found) = on_surface(self.scene, self.rims, &rays, drifts, counts);
        if found.is_empty() {
            return end >= 1.0;
        }
        let chance = if end < 1.0 {
            self.chance(number, is_reversed, end, counts)
        } else {
            1.0
        };
        for found in found {
            let inward = if found.goes_in { PROBE } else { -PROBE };
            let is_lit_after = found.goes_in != is_reversed;
            met.push(Met {
                shadow: found.shadow,
                boundary: found.boundary,
                direction: arc.direction(found.s).normalize(),
                looked_at: arc.direction(found.s + inward).normalize(),
                jump: if is_lit_after { -1.0 } else { 1.0 } / chance,
            });
        }
        end >= 1.0
    }

    /// The chance that a point of the line lies on what one end of a cell sees, which ends in it.
    fn chance(&self, number: usize, is_reversed: bool, end: f64, counts: &mut Counts) -> f64 {
        let back = if is_reversed {
            Some(number + 1).filter(|&n| n < self.cells.len())
        } else {
            number.checked_sub(1)
        };
        let Some(back) = back else { return 1.0 };
        let there = self.cells[number].rays(is_reversed).arc.direction(end);
        let rays = self.cells[back].rays(!is_reversed);
        let here = rays.arc.direction(surface_end(self.scene, &rays, counts));
        let mut ends = [there, here].map(|d| self.line.psi_of(d));
        ends.sort_by(f64::total_cmp);
        self.line.chance_between(ends).max(SMALLEST_CHANCE)
    }
}
