//! What the camera sees: where the radiance jumps along the rows and columns of a tile's lattice.
//!
//! The same cells as for light (`super::light_cells`), on the film: between two neighbours of a lattice row the
//! interval of film is shifted rigidly with the silhouette that lies in it, and what the change of variables leaves is the
//! jump of the radiance times the silhouette's speed. Rows give the speed's part along x, columns the part along y. The
//! pixel filter multiplies the jump *where the silhouette is*: it is neither moved nor differentiated, so a box filter is
//! as good as a smooth one, and no kernel blurs the image.
//!
//! The jump is L₋ − L₊ right beside the silhouette, from one ray on either side. The two share their random numbers,
//! as a correlated pair: at an edge of a flat-shaded surface both see the same light sample, and only the normals differ.

use super::beside::Beside;
use super::film_cell::{Borders, Candidate, Cell, LatticeLine, first_hit, steps};
use super::film_runs;
use super::lattice::Tile;
use super::moving::Sector;
use super::rays::{RayPacket, from_lanes};
use super::store::FilmCrossing;
use super::tile::to_rgb;
use super::tracer::{Counts, Tracer};
use crate::lanes::LANES;
use crate::paths::camera::splat;
use crate::scene::Rgb;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::{dvec3, velocity_per_side};
use crate::warp::crossing::Kind;
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;

/// What the lattice of a tile saw: row by row.
pub struct LatticeImage {
    pub triangle: Vec<u32>,
    pub radiance: Vec<Rgb>,
}

/// A crossing in the tile at which the radiance jumps.
pub(super) struct Met {
    pub line: LatticeLine,
    /// Distance from the line's first point in steps of the lattice.
    pub steps: f64,
    pub is_silhouette: bool,
    pub crossing: FilmCrossing,
}

/// The crossings between all neighbours between which something that moves may be seen.
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    tile: &Tile,
    image: &LatticeImage,
    counts: &mut Counts,
) -> Vec<FilmCrossing> {
    let film = LatticeCells {
        tracer,
        adjacency,
        tile,
        image,
    };
    let [columns, rows] = tile.points;
    let mut candidates = Vec::new();
    let mut borders = Borders::new();
    let mut skipped = BTreeSet::new();
    for axis in 0..2 {
        for row in 0..rows - axis {
            for column in 0..columns - (1 - axis) {
                let (number, at) = if axis == 0 {
                    (row, column)
                } else {
                    (column, row)
                };
                let line = LatticeLine { axis, number };
                let (point, next) = (film.index(line, at), film.index(line, at + 1));
                let (a, b) = (image.triangle[point], image.triangle[next]);
                let differ = a != b || tracer.geometry.has_painted_edges(a);
                if !tile.is_inner(1 - axis, number) || !differ {
                    continue;
                }
                if !film.moves(line, at) {
                    skipped.insert((line, at as i64));
                    continue;
                }
                let dimension = CHOICE + (axis * columns * rows + point) as u32;
                let mut choice = tile.stream.uniform(dimension) as f64;
                // Equal radiances mostly mean that there is no jump, unless both are in shadow.
                let mut weight = 1;
                let radiance = image.radiance[point];
                if radiance == image.radiance[next] && radiance != [0.0; 3] {
                    weight = UNLIKELY;
                    choice *= UNLIKELY as f64;
                    if choice >= 1.0 {
                        skipped.insert((line, at as i64));
                        continue;
                    }
                }
                let cell = Cell {
                    weight,
                    number: (axis * columns * rows + point) as u32,
                    ..film.cell(line, at as i64, 1, counts)
                };
                candidates.extend(cell.all_crossings(Some(choice), &mut borders, counts));
            }
        }
    }
    let mut met = Vec::new();
    for round in 0..ROUNDS {
        candidates = probe(&film, &candidates, round, &mut met, &mut borders, counts);
        if candidates.is_empty() {
            break;
        }
    }
    film_runs::weigh(&film, &mut met, borders, &skipped, counts);
    met.into_iter().map(|met| met.crossing).collect()
}

/// The cells of a tile's lattice.
pub(super) struct LatticeCells<'a> {
    pub tracer: &'a Tracer<'a>,
    pub adjacency: &'a Adjacency,
    pub tile: &'a Tile,
    image: &'a LatticeImage,
}

impl<'a> LatticeCells<'a> {
    fn index(&self, line: LatticeLine, at: usize) -> usize {
        let [column, row] = if line.axis == 0 {
            [at, line.number]
        } else {
            [line.number, at]
        };
        row * self.tile.points[0] + column
    }

    /// The triangle seen at a point of a line, which may lie beyond the lattice.
    fn triangle(&self, line: LatticeLine, at: i64, counts: &mut Counts) -> u32 {
        if (0..self.tile.points[line.axis] as i64).contains(&at) {
            return self.image.triangle[self.index(line, at as usize)];
        }
        counts.probe += 1;
        first_hit(self.tracer, self.position(line, at))
    }

    fn position(&self, line: LatticeLine, at: i64) -> [f64; 2] {
        let tile = self.tile;
        let mut position = [tile.position(1 - line.axis, line.number); 2];
        position[line.axis] = tile.first[line.axis] + at as f64 * tile.step[line.axis];
        position
    }

    /// The interval from point number `at` of a line to the one `steps` further.
    pub fn cell(&self, line: LatticeLine, at: i64, steps: i64, counts: &mut Counts) -> Cell<'a> {
        Cell {
            tracer: self.tracer,
            adjacency: self.adjacency,
            tile: self.tile,
            start: self.position(line, at),
            line,
            length: steps as f64 * self.tile.step[line.axis],
            triangles: [at, at + steps].map(|at| self.triangle(line, at, counts)),
            weight: 1,
            number: 0,
        }
    }

    /// Whether something that moves may be seen between point number `at` of a line and the next.
    fn moves(&self, line: LatticeLine, at: usize) -> bool {
        let [a, b] = [at, at + 1].map(|at| self.direction(line, at as f64));
        let origin = self.tracer.camera.origin.as_dvec3();
        self.tracer.moving.meets(&Sector::between(origin, a, b))
    }

    /// The direction at a distance from a line's first point in steps of the lattice.
    pub fn direction(&self, line: LatticeLine, steps: f64) -> DVec3 {
        let mut at = self.position(line, 0);
        at[line.axis] += steps * self.tile.step[line.axis];
        dvec3(self.tracer.camera.direction(at[0], at[1]))
    }

    /// Adds where something else begins to be seen in a cell that was not searched, or lies beyond the lattice.
    pub fn find_borders(
        &self,
        line: LatticeLine,
        cell: i64,
        borders: &mut Borders,
        counts: &mut Counts,
    ) {
        let cell = self.cell(line, cell, 1, counts);
        let mut found = cell.all_crossings(None, borders, counts);
        for _ in 0..ROUNDS {
            let mut rest = Vec::new();
            for candidate in &found {
                let beside = candidate.beside().map(|at| first_hit(self.tracer, at));
                counts.probe += 2;
                candidate.add_border(beside, borders);
                rest.extend(candidate.rest(beside, borders, counts));
            }
            found = rest;
        }
    }
}

/// Silhouettes behind one another that are looked for in one cell.
pub(super) const ROUNDS: u32 = 4;

/// Of the cells whose ends look alike one in this many is searched, and stands for all.
const UNLIKELY: u32 = 8;

/// Dimensions from here on choose among several edges in a cell.
const CHOICE: u32 = 16;

/// Looks on both sides of each candidate, and adds to `met` at which the radiance jumps. Returns what else must lie in their
/// cells.
fn probe<'a>(
    film: &LatticeCells<'a>,
    candidates: &[Candidate<'a>],
    round: u32,
    met: &mut Vec<Met>,
    borders: &mut Borders,
    counts: &mut Counts,
) -> Vec<Candidate<'a>> {
    let LatticeCells { tracer, tile, .. } = *film;
    let mut rest = Vec::new();
    let mut last = (u32::MAX, 0);
    for group in candidates.chunks(LANES / 2) {
        let mut directions = [Vec3::Z; LANES];
        for (i, candidate) in group.iter().enumerate() {
            for (k, [u, v]) in candidate.beside().into_iter().enumerate() {
                directions[2 * i + k] = dvec3(tracer.camera.direction(u, v)).as_vec3();
            }
        }
        let mut index = [PROBE_INDEX; LANES];
        let mut sides = Beside::default();
        for (i, candidate) in group.iter().enumerate() {
            let Cell { number, .. } = candidate.cell;
            let place = if last.0 == number { last.1 + 1 } else { 0 };
            last = (number, place);
            // Both sides of a crossing share their random numbers, and nothing else does.
            let own = (number * ROUNDS + round) * PROBES_PER_ROUND + place;
            index[2 * i..2 * i + 2].fill(PROBE_INDEX + own);
            let moves = tracer
                .moving
                .boundary(tracer.geometry, &candidate.crossing.boundary);
            sides.add(i, moves, candidate.crossing.kind == Kind::Bend);
        }
        let rays = RayPacket {
            active: sides.active,
            origin: splat(tracer.camera.origin),
            direction: from_lanes(&directions),
            near: tracer.camera.near_clip,
            far: tracer.camera.far_clip,
        };
        let (radiance, seen) =
            tracer.radiance_along(rays, sides, 0, true, &tile.stream, &index, counts);
        let radiance = to_rgb(radiance);
        for (i, candidate) in group.iter().enumerate() {
            let (before, after) = (radiance[2 * i], radiance[2 * i + 1]);
            let jump: Rgb =
                std::array::from_fn(|c| (before[c] - after[c]) * candidate.crossing.count as f32);
            let is_finite = jump.iter().all(|j| j.is_finite());
            counts.boundary_not_finite += !is_finite as u64;
            let [u, v] = candidate.at;
            let line = candidate.cell.line;
            let seen = [seen[2 * i], seen[2 * i + 1]];
            let is_hidden = candidate.crossing.is_hidden(seen);
            if is_finite && jump != [0.0; 3] && !is_hidden && tile.contains(u, v) {
                met.push(Met {
                    line,
                    steps: steps(tile, line, candidate.at),
                    is_silhouette: candidate.crossing.is_silhouette(),
                    crossing: FilmCrossing {
                        boundary: candidate.crossing.boundary,
                        axis: line.axis as u8,
                        at: candidate.at,
                        jump,
                    },
                });
            }
            if candidate.crossing.is_silhouette() {
                candidate.add_border(seen, borders);
                rest.extend(candidate.rest(seen, borders, counts));
            }
        }
    }
    rest
}

/// Sample indices of probes: apart from those of the lattice, which are Morton codes of small numbers.
const PROBE_INDEX: u32 = 0x8000_0000;
/// More than are found at once in a cell.
const PROBES_PER_ROUND: u32 = 64;

impl FilmCrossing {
    /// Film velocity along the crossing's axis, in pixels, per unit of Ḟ.
    pub fn velocity_per_side(&self, tracer: &Tracer) -> Option<f64> {
        let c = self
            .boundary
            .normal(tracer.geometry, tracer.camera.origin.as_dvec3());
        let gradient = tracer.camera.direction_per_pixel().map(|d| c.dot(d));
        velocity_per_side(gradient, [1.0, 0.0, 1.0], self.axis as usize)
    }
}
