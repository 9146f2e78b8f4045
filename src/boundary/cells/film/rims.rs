//! Where the beams of lights end along the rows and columns of a tile's lattice.
//!
//! Where that is on a surface is known without a search, so that all of it is found on surfaces
//! that a point of the lattice sees.

use super::cell::{LatticeCells, LatticeLine};
use super::shadow_border::{Border, SMALLEST_CHANCE, between};
use crate::boundary::cells::delta::follow::surface_end;
use crate::boundary::cells::delta::rim::{Rim, on_surface};
use crate::paths::counts::Counts;
use crate::trace::geometry::NO_TRIANGLE;

/// Finds the borders that move.
pub fn find(cells: &LatticeCells, borders: &mut Vec<Border>, counts: &mut Counts) {
    let rims = Rim::all(cells.scene.view.delta_lights);
    if rims.is_empty() || !cells.scene.moving.anything() {
        return;
    }
    let tile = cells.film.tile;
    for axis in 0..2 {
        for number in 1..tile.points[1 - axis] - 1 {
            let line = LatticeLine { axis, number };
            for at in 0..tile.points[axis] as i64 - 1 {
                if !from_point(cells, line, [at, at + 1], &rims, borders, counts) {
                    from_point(cells, line, [at + 1, at], &rims, borders, counts);
                }
            }
        }
    }
}

/// Looks for them from what is seen at a point of a line toward one beside it. Says whether both
/// see one surface.
fn from_point(
    cells: &LatticeCells,
    line: LatticeLine,
    [from, to]: [i64; 2],
    rims: &[(usize, Rim)],
    borders: &mut Vec<Border>,
    counts: &mut Counts,
) -> bool {
    let (scene, tile) = (cells.scene, cells.film.tile);
    let rays = between(cells, line, [from, to], counts);
    if rays.seen[0] == NO_TRIANGLE {
        return rays.seen[1] == NO_TRIANGLE;
    }
    let along = (to - from) as f64;
    let position = |s: f64| {
        let mut at = cells.position(line, from);
        at[line.axis] += s * along * tile.step[line.axis];
        at
    };
    let drifts = |s: f64| cells.film.drifts(position(s));
    let (end, found) = on_surface(scene, rims, &rays, drifts, counts);
    let mut chance = None;
    for found in found {
        let at = position(found.s);
        if !tile.contains(at) {
            continue;
        }
        // A point lies on the surface with certainty, unless less than a step of it is seen.
        let chance = *chance.get_or_insert_with(|| {
            if end >= 1.0 {
                return 1.0;
            }
            let back = between(cells, line, [from, 2 * from - to], counts);
            (end + surface_end(scene, &back, counts)).clamp(SMALLEST_CHANCE, 1.0)
        });
        let inward = if found.goes_in { along } else { -along };
        borders.push(Border {
            boundary: found.boundary,
            shadow: found.shadow,
            is_own: false,
            axis: line.axis,
            at,
            lit_side: inward,
            jump: -inward / chance,
        });
    }
    end >= 1.0
}
