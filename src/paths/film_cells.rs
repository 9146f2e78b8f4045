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

use super::lattice::Tile;
use super::rays::{RayPacket, from_lanes};
use super::store::FilmCrossing;
use super::tile::to_rgb;
use super::tracer::{Counts, Tracer};
use crate::lanes::LANES;
use crate::paths::camera::splat;
use crate::scene::Rgb;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::{Boundary, dvec3, velocity_per_side};
use crate::warp::resolve::{Crossing, Unresolved, between, between_halves};
use crate::warp::walk::Arc;
use glam::{DVec3, Vec3};

/// How far beside a silhouette the probes look, in pixels, and at most as a fraction of the cell.
const PROBE_PIXELS: f64 = 1e-3;
const PROBE_CELL: f64 = 0.1;

/// What the lattice of a tile saw: row by row.
pub struct LatticeImage {
    pub triangle: Vec<u32>,
    pub radiance: Vec<Rgb>,
}

/// A crossing before its jump is known.
struct Candidate<'a> {
    boundary: Boundary,
    at: [f64; 2],
    /// Number of crossings it stands for.
    count: u32,
    /// Where it was found, and where in that: 0 to 1.
    cell: Cell<'a>,
    s: f64,
    /// Not an edge within what is seen.
    is_silhouette: bool,
}

/// The crossings between all neighbours for which `moves(a, b)` says that the boundary between their triangles can move.
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    tile: &Tile,
    image: &LatticeImage,
    moves: impl Fn(u32, u32) -> bool,
    counts: &mut Counts,
) -> Vec<FilmCrossing> {
    let [columns, rows] = tile.points;
    let mut candidates = Vec::new();
    for axis in 0..2 {
        let stride = if axis == 0 { 1 } else { columns };
        for row in 0..rows - axis {
            for column in 0..columns - (1 - axis) {
                let inner = if axis == 0 {
                    tile.is_inner(1, row)
                } else {
                    tile.is_inner(0, column)
                };
                let at = row * columns + column;
                let (a, b) = (image.triangle[at], image.triangle[at + stride]);
                let differ = a != b || tracer.geometry.has_painted_edges(a);
                if inner && differ && moves(a, b) {
                    let dimension = CHOICE + (axis * columns * rows + at) as u32;
                    let mut choice = tile.stream.uniform(dimension) as f64;
                    // Equal radiances mostly mean that there is no jump, unless both are in shadow.
                    let mut weight = 1;
                    let radiance = image.radiance[at];
                    if radiance == image.radiance[at + stride] && radiance != [0.0; 3] {
                        weight = UNLIKELY;
                        choice *= UNLIKELY as f64;
                        if choice >= 1.0 {
                            continue;
                        }
                    }
                    let cell = Cell {
                        tracer,
                        adjacency,
                        tile,
                        start: [tile.position(0, column), tile.position(1, row)],
                        length: tile.step[axis],
                        axis,
                        triangles: [a, b],
                        weight,
                    };
                    candidates.extend(cell.all_crossings(choice, counts));
                }
            }
        }
    }
    let mut found = Vec::new();
    for _ in 0..ROUNDS {
        candidates = probe(tracer, tile, &candidates, &mut found, counts);
        if candidates.is_empty() {
            break;
        }
    }
    found
}

/// Silhouettes behind one another that are looked for in one cell.
const ROUNDS: usize = 4;

/// Of the cells whose ends look alike one in this many is searched, and stands for all.
const UNLIKELY: u32 = 8;

/// Dimensions from here on choose among several edges in a cell.
const CHOICE: u32 = 16;

/// How far beside a silhouette the probes of a cell look, in pixels.
fn beside(tile: &Tile, axis: usize) -> f64 {
    PROBE_PIXELS.min(PROBE_CELL * tile.step[axis])
}

/// The interval between two neighbours, or a part of it.
#[derive(Clone, Copy)]
struct Cell<'a> {
    tracer: &'a Tracer<'a>,
    adjacency: &'a Adjacency,
    tile: &'a Tile,
    start: [f64; 2],
    /// Pixels along `axis`.
    length: f64,
    axis: usize,
    /// What its ends see.
    triangles: [u32; 2],
    /// How many cells it stands for.
    weight: u32,
}

impl<'a> Cell<'a> {
    /// Film position and direction at `s`.
    fn at(&self, s: f64) -> ([f64; 2], DVec3) {
        let mut at = self.start;
        at[self.axis] += s * self.length;
        (at, dvec3(self.tracer.camera.direction(at[0], at[1])))
    }

    /// What lies between the triangles seen at its ends, as far as it lies in the tile.
    fn crossings(&self, choice: f64) -> Result<[Option<Candidate<'a>>; 2], Unresolved> {
        let arc = Arc {
            origin: self.tracer.camera.origin.as_dvec3(),
            a: self.at(0.0).1,
            b: self.at(1.0).1,
        };
        let found = between(
            self.tracer.geometry,
            self.adjacency,
            &arc,
            self.triangles,
            choice,
            2.0 * beside(self.tile, self.axis) / self.length,
        )?;
        let [silhouette, ridge] = found;
        let candidate = |crossing: Option<Crossing>, is_silhouette: bool| {
            let Crossing { boundary, s, count } = crossing?;
            let (at, _) = self.at(s);
            self.tile.contains(at[0], at[1]).then_some(Candidate {
                boundary,
                at,
                count: count * self.weight,
                cell: *self,
                s,
                is_silhouette,
            })
        };
        Ok([candidate(silhouette, true), candidate(ridge, false)])
    }

    /// The same where something else may stand in front of both triangles.
    fn all_crossings(&self, choice: f64, counts: &mut Counts) -> Vec<Candidate<'a>> {
        let mut probes = 0;
        let seen = |s: f64| {
            probes += 1;
            let tracer = self.tracer;
            let direction = self.at(s).1.as_vec3();
            let [near, far] = [tracer.camera.near_clip, tracer.camera.far_clip];
            tracer.first_hit(tracer.camera.origin, direction, near, far)
        };
        let find = |place, triangles| self.part(place, triangles).crossings(choice);
        let (found, unresolved) = between_halves(self.triangles, seen, find);
        counts.probe += probes;
        counts.unresolved += unresolved;
        found.into_iter().flatten().flatten().collect()
    }

    /// The part between two places, at which these triangles are seen.
    fn part(&self, [from, to]: [f64; 2], triangles: [u32; 2]) -> Self {
        Self {
            start: self.at(from).0,
            length: (to - from) * self.length,
            triangles,
            ..*self
        }
    }

    /// The silhouettes in the parts on either side of `s`, beside which `seen` is seen: where that is not what the ends
    /// see, something else ends in between.
    fn rest(&self, s: f64, seen: [u32; 2], counts: &mut Counts) -> Vec<Candidate<'a>> {
        let beside = beside(self.tile, self.axis) / self.length;
        let [a, b] = self.triangles;
        let [before, after] = seen;
        let parts = [
            (0.0, s - beside, [a, before]),
            (s + beside, 1.0, [after, b]),
        ];
        let mut rest = Vec::new();
        for (from, to, triangles) in parts {
            if triangles[0] == triangles[1] || from >= to {
                continue;
            }
            let found = self.part([from, to], triangles).all_crossings(0.0, counts);
            // Edges within what is seen were chosen for the whole cell already.
            rest.extend(found.into_iter().filter(|c| c.is_silhouette));
        }
        rest
    }
}

/// Looks on both sides of each candidate; those with a jump are added to `found`. Returns what else must lie in their cells.
fn probe<'a>(
    tracer: &Tracer,
    tile: &Tile,
    candidates: &[Candidate<'a>],
    found: &mut Vec<FilmCrossing>,
    counts: &mut Counts,
) -> Vec<Candidate<'a>> {
    let mut rest = Vec::new();
    for (number, group) in candidates.chunks(LANES / 2).enumerate() {
        let mut directions = [Vec3::Z; LANES];
        for (i, candidate) in group.iter().enumerate() {
            let axis = candidate.cell.axis;
            let beside = beside(tile, axis);
            for (k, side) in [-beside, beside].into_iter().enumerate() {
                let mut at = candidate.at;
                at[axis] += side;
                directions[2 * i + k] = dvec3(tracer.camera.direction(at[0], at[1])).as_vec3();
            }
        }
        let rays = RayPacket {
            active: (1 << (2 * group.len())) - 1,
            origin: splat(tracer.camera.origin),
            direction: from_lanes(&directions),
            near: tracer.camera.near_clip,
            far: tracer.camera.far_clip,
        };
        let index = std::array::from_fn(|l| PROBE_INDEX + (number * LANES / 2 + l / 2) as u32);
        let (radiance, seen) = tracer.radiance_along(rays, 0, true, &tile.stream, &index, counts);
        let radiance = to_rgb(radiance);
        for (i, candidate) in group.iter().enumerate() {
            let (before, after) = (radiance[2 * i], radiance[2 * i + 1]);
            let jump: Rgb =
                std::array::from_fn(|c| (before[c] - after[c]) * candidate.count as f32);
            if jump.iter().any(|j| !j.is_finite()) {
                counts.not_finite += 1;
            } else if jump != [0.0; 3] {
                found.push(FilmCrossing {
                    boundary: candidate.boundary,
                    axis: candidate.cell.axis as u8,
                    at: candidate.at,
                    jump,
                });
            }
            if candidate.is_silhouette {
                let seen = [seen[2 * i], seen[2 * i + 1]];
                rest.extend(candidate.cell.rest(candidate.s, seen, counts));
            }
        }
    }
    rest
}

/// Sample indices of probes: apart from those of the lattice, which are Morton codes of small numbers.
const PROBE_INDEX: u32 = 0x8000_0000;

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
