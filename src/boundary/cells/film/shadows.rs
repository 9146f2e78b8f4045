//! Where the shadows of delta lights end along the rows and columns of a tile's lattice.
//!
//! A *shadow* on a line is an interval in which one surface is seen and the light is hidden from
//! all of it. From a point of the lattice that lies in it both of its ends are found, whatever lies
//! elsewhere on the line, and its chance of being met is its length in steps, or 1.

use super::cell::{FilmCell, LatticeCells, LatticeLine};
use super::shadow_border::{Border, SMALLEST_CHANCE, between};
use crate::boundary::cells::delta::follow::{Followed, follow};
use crate::boundary::cells::delta::receiver::Receiver;
use crate::boundary::cells::line_search::Cell;
use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Shadow;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::estimator::FilmTile;

/// Of the cells both of whose ends are hidden one in this many is searched and stands for all.
const UNLIKELY: u32 = 8;
/// Finds the borders of all shadows that move.
pub fn find(cells: &LatticeCells, borders: &mut Vec<Border>, counts: &mut Counts) {
    for light in 0..cells.film.image.hidden.len() {
        of_light(cells, light, borders, counts);
    }
}

fn of_light(cells: &LatticeCells, light: usize, borders: &mut Vec<Border>, counts: &mut Counts) {
    let tile = cells.film.tile;
    let hidden = hidden(cells, light, counts);
    if !hidden.contains(&true) {
        return;
    }
    let [columns, rows] = tile.points;
    for axis in 0..2 {
        for row in 0..rows - axis {
            for column in 0..columns - (1 - axis) {
                let (number, at) = if axis == 0 {
                    (row, column)
                } else {
                    (column, row)
                };
                let line = LatticeLine { axis, number };
                let (point, next) = (cells.index(line, at), cells.index(line, at + 1));
                let is_hidden = [hidden[point], hidden[next]];
                if !tile.is_inner(1 - axis, number) || is_hidden == [false; 2] {
                    continue;
                }
                let mut weight = 1;
                if is_hidden == [true; 2] {
                    let name = [(axis * columns * rows + point) as u32, light as u32, 0];
                    weight = UNLIKELY;
                    if tile.stream.single(Single::FilmShadow, name) * weight as f32 >= 1.0 {
                        continue;
                    }
                }
                let cell = cells.cell(line, at as i64, counts);
                if !moves(cells, &cell, light) {
                    continue;
                }
                for end in (0..2).filter(|&end| is_hidden[end]) {
                    let search = ShadowCell {
                        cells,
                        light,
                        line,
                        points: [at as i64 + end as i64, at as i64 + 1 - end as i64],
                        is_hidden: is_hidden[1 - end],
                        weight: f64::from(weight),
                    };
                    borders.extend(search.border(counts));
                }
            }
        }
    }
}

/// At which points of the lattice something hides the light from what is seen. Of what is made of
/// several materials paths meet one, which need not be one that is lit.
fn hidden(cells: &LatticeCells, light: usize, counts: &mut Counts) -> Vec<bool> {
    let FilmTile {
        tile, image, view, ..
    } = *cells.film;
    let mut hidden = image.hidden[light].clone();
    let columns = tile.points[0];
    let mixed = (0..hidden.len()).filter(|&at| view.is_mixed(image.triangle[at]));
    for at in mixed {
        let position = [0, 1].map(|axis| tile.position(axis, [at % columns, at / columns][axis]));
        let receiver = Receiver::new(cells.scene, light, image.triangle[at]);
        let origin = view.camera.eye();
        hidden[at] = receiver.is_hidden(origin, cells.direction_at(position), counts);
    }
    hidden
}

/// Whether a shadow may move that is seen in a cell.
fn moves(cells: &LatticeCells, cell: &FilmCell, light: usize) -> bool {
    let scene = cells.scene;
    let [a, b] = cell.triangles();
    if a != b || cells.film.drifts(cell.position(0.5)) {
        return scene.moving.anything();
    }
    scene.moving.shines_anew(scene.view.geometry, light, a) || {
        let receiver = Receiver::new(scene, light, a);
        scene.moving.meets(&receiver.sector(&cell.arc()))
    }
}

/// The interval from a point of the lattice in the shadow to one beside it.
struct ShadowCell<'a> {
    cells: &'a LatticeCells<'a>,
    light: usize,
    line: LatticeLine,
    points: [i64; 2],
    /// Whether the other lies in a shadow, too.
    is_hidden: bool,
    weight: f64,
}

impl ShadowCell<'_> {
    /// Where the shadow of the first point ends in the cell.
    fn border(&self, counts: &mut Counts) -> Option<Border> {
        let [from, to] = self.points;
        let geometry = self.cells.scene.view.geometry;
        let end = match self.follow(to, 1.0, counts) {
            Followed::Shadow(end) => end,
            Followed::Lost(_) => {
                counts.unresolved += 1;
                return None;
            }
            Followed::AllHidden => {
                counts.unresolved += u64::from(!self.is_hidden);
                return None;
            }
            Followed::Surface(_) => return None,
        };
        let along = to - from;
        let mut at = self.cells.position(self.line, from);
        at[self.line.axis] += end.s * along as f64 * self.cells.film.tile.step[self.line.axis];
        let boundary = Boundary::Edge(end.edge);
        let moving = self.cells.scene.moving;
        let moves = moving.boundary(geometry, &boundary)
            || moving.shines_anew(geometry, self.light, end.receiver)
            || self.cells.film.drifts(at);
        if !moves || !self.cells.film.tile.contains(at) {
            return None;
        }
        // Its other end matters if it is nearer than a step.
        let back = self.follow(from - along, 1.0 - end.s, counts).end();
        let chance = back.map_or(1.0, |s| (end.s + s).clamp(SMALLEST_CHANCE, 1.0));
        Some(Border {
            boundary,
            shadow: Shadow {
                light: self.light as u32,
                receiver: end.receiver,
            },
            is_own: false,
            axis: self.line.axis,
            at,
            lit_side: 0.0,
            jump: -along as f64 * self.weight / chance,
        })
    }

    /// Follows the shadow of the first point toward a point beside it.
    fn follow(&self, to: i64, limit: f64, counts: &mut Counts) -> Followed {
        let (cells, light) = (self.cells, self.light);
        let rays = between(cells, self.line, [self.points[0], to], counts);
        follow(cells.scene, light, &rays, limit, counts)
    }
}
