//! Where the shadows of delta lights end along the rows and columns of a tile's lattice.
//!
//! A *shadow* on a line is an interval in which one surface is seen and the light is hidden from
//! all of it. From a point of the lattice that lies in it both of its ends are found, whatever lies
//! elsewhere on the line, and its chance of being met is its length in steps, or 1.

use super::cell::{FilmCell, LatticeCells, LatticeLine};
use super::terminators;
use crate::boundary::cells::delta::follow::{Followed, Rays, follow};
use crate::boundary::cells::delta::receiver::{self, Receiver};
use crate::boundary::cells::delta::value::brought;
use crate::boundary::cells::line_search::Cell;
use crate::discontinuity::boundary::{Boundary, velocity_per_side};
use crate::lanes::LANES;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, Shadow};
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::estimator::FilmTile;
use crate::paths::rays::from_lanes;
use glam::{DVec3, Vec3};

/// Of the cells both of whose ends are hidden one in this many is searched and stands for all.
const UNLIKELY: u32 = 8;
/// Shadows are taken to be met with this chance at least: it bounds the weight of their ends.
pub const SMALLEST_CHANCE: f64 = 1e-3;

/// The border of a shadow.
pub struct Border {
    pub boundary: Boundary,
    pub shadow: Shadow,
    /// Whether the edge that throws the shadow is the receiver's own.
    pub is_own: bool,
    pub axis: usize,
    pub at: [f64; 2],
    /// What the light's radiance is multiplied with: +1 if it is hidden beyond, −1 if before, over
    /// the chance of finding it.
    pub jump: f64,
}

/// Finds the borders of all shadows that move.
pub fn find(cells: &LatticeCells, out: &mut Found) {
    let mut borders = Vec::new();
    for light in 0..cells.film.image.hidden.len() {
        of_light(cells, light, &mut borders, &mut out.counts);
    }
    if !cells.film.image.hidden.is_empty() {
        terminators::find(cells, &mut borders, &mut out.counts);
    }
    for group in borders.chunks(LANES) {
        let jumps = jumps(cells, group, &mut out.counts);
        for (border, jump) in group.iter().zip(jumps) {
            if !jump.is_finite() {
                out.counts.boundary_not_finite += 1;
            } else if jump != DVec3::ZERO {
                out.samples.extend(sample(cells, border, jump));
            }
        }
    }
}

fn of_light(cells: &LatticeCells, light: usize, borders: &mut Vec<Border>, counts: &mut Counts) {
    let FilmTile { tile, image, .. } = *cells.film;
    let hidden = &image.hidden[light];
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

/// The rays from one point of a line to one beside it.
pub fn between<'a>(
    cells: &LatticeCells<'a>,
    line: LatticeLine,
    [from, to]: [i64; 2],
    counts: &mut Counts,
) -> Rays<impl Fn(f64) -> u32 + use<'a>> {
    let cell = cells.cell(line, from.min(to), counts);
    let is_reversed = to < from;
    let (mut arc, mut seen) = (cell.arc(), cell.triangles());
    if is_reversed {
        arc = arc.reversed();
        seen.reverse();
    }
    Rays {
        arc,
        seen,
        first_hit: move |s: f64| cell.first_hit(if is_reversed { 1.0 - s } else { s }),
    }
}

/// What the radiance jumps by at each of a group of borders.
fn jumps(cells: &LatticeCells, group: &[Border], counts: &mut Counts) -> Vec<DVec3> {
    let mut directions = [Vec3::Z; LANES];
    let [mut receivers, mut lights] = [[0; LANES]; 2];
    for (lane, border) in group.iter().enumerate() {
        directions[lane] = cells.direction_at(border.at).as_vec3();
        receivers[lane] = border.shadow.receiver;
        lights[lane] = border.shadow.light;
    }
    let active = u32::MAX >> (32 - group.len());
    let rays = cells
        .scene
        .view
        .camera
        .rays(from_lanes(&directions), active);
    let brought = brought(cells.scene, &rays, &receivers, &lights, counts);
    let jump = |(border, brought): (&Border, DVec3)| brought * border.jump;
    group.iter().zip(brought).map(jump).collect()
}

/// The jump times the border's speed per unit of Ḟ along the line, over the lines' density.
fn sample(cells: &LatticeCells, border: &Border, jump: DVec3) -> Option<BoundarySample> {
    let &Border {
        boundary,
        shadow,
        is_own,
        axis,
        at,
        ..
    } = border;
    let camera = &cells.scene.view.camera;
    let (origin, d) = (camera.origin.as_dvec3(), cells.direction_at(at));
    let c = if is_own {
        boundary.normal(cells.scene.view.geometry, origin)
    } else {
        receiver::normal(cells.scene, &boundary, &shadow, origin, d)
    };
    let gradient = camera.direction_per_pixel().map(|d| c.dot(d));
    let velocity = velocity_per_side(gradient, [1.0, 0.0, 1.0], axis)?;
    let weight = jump * (velocity * cells.film.tile.step[1 - axis]);
    Some(BoundarySample {
        boundary,
        shadow: (!is_own).then_some(shadow),
        lane: 0,
        at: Coordinate::Film(at),
        weight: weight.as_vec3().to_array(),
    })
}
