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
use crate::warp::resolve::{Crossing, Unresolved, between};
use crate::warp::walk::Arc;
use glam::Vec3;

/// How far beside a silhouette the probes look, in pixels, and at most as a fraction of the cell.
const PROBE_PIXELS: f64 = 1e-3;
const PROBE_CELL: f64 = 0.1;

/// What the lattice of a tile saw: row by row.
pub struct LatticeImage {
    pub triangle: Vec<u32>,
    pub radiance: Vec<Rgb>,
}

/// A crossing before its jump is known.
struct Candidate {
    boundary: Boundary,
    axis: usize,
    at: [f64; 2],
    /// Number of crossings it stands for.
    count: u32,
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
                if inner && a != b && moves(a, b) {
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
                    let start = [tile.position(0, column), tile.position(1, row)];
                    let cell = Cell {
                        tracer,
                        adjacency,
                        tile,
                        start,
                        axis,
                    };
                    match cell.crossings([a, b], choice) {
                        Ok(found) => {
                            candidates.extend(found.into_iter().flatten().map(|c| Candidate {
                                count: c.count * weight,
                                ..c
                            }))
                        }
                        Err(Unresolved) => counts.unresolved += 1,
                    }
                }
            }
        }
    }
    probe(tracer, tile, &candidates, counts)
}

/// Of the cells whose ends look alike one in this many is searched, and stands for all.
const UNLIKELY: u32 = 8;

/// Dimensions from here on choose among several edges in a cell.
const CHOICE: u32 = 16;

/// How far beside a silhouette the probes of a cell look, in pixels.
fn beside(tile: &Tile, axis: usize) -> f64 {
    PROBE_PIXELS.min(PROBE_CELL * tile.step[axis])
}

/// The interval between two neighbours.
struct Cell<'a> {
    tracer: &'a Tracer<'a>,
    adjacency: &'a Adjacency,
    tile: &'a Tile,
    start: [f64; 2],
    axis: usize,
}

impl Cell<'_> {
    /// What lies between the triangles seen at its ends, as far as it lies in the tile.
    fn crossings(
        &self,
        triangles: [u32; 2],
        choice: f64,
    ) -> Result<[Option<Candidate>; 2], Unresolved> {
        let camera = &self.tracer.camera;
        let axis = self.axis;
        let direction = |along: f64| {
            let mut at = self.start;
            at[axis] += along * self.tile.step[axis];
            (at, dvec3(camera.direction(at[0], at[1])))
        };
        let arc = Arc {
            origin: camera.origin.as_dvec3(),
            a: direction(0.0).1,
            b: direction(1.0).1,
        };
        let found = between(
            self.tracer.geometry,
            self.adjacency,
            &arc,
            triangles,
            choice,
            2.0 * beside(self.tile, axis) / self.tile.step[axis],
        )?;
        Ok(found.map(|crossing| {
            let Crossing { boundary, s, count } = crossing?;
            let (at, _) = direction(s);
            self.tile.contains(at[0], at[1]).then_some(Candidate {
                boundary,
                axis,
                at,
                count,
            })
        }))
    }
}

/// Looks on both sides of each candidate; those without a jump are dropped.
fn probe(
    tracer: &Tracer,
    tile: &Tile,
    candidates: &[Candidate],
    counts: &mut Counts,
) -> Vec<FilmCrossing> {
    let mut found = Vec::new();
    for (number, group) in candidates.chunks(LANES / 2).enumerate() {
        let mut directions = [Vec3::Z; LANES];
        for (i, candidate) in group.iter().enumerate() {
            let axis = candidate.axis;
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
        let radiance = to_rgb(tracer.radiance_along(rays, 0, true, &tile.stream, &index, counts));
        for (i, candidate) in group.iter().enumerate() {
            let (before, after) = (radiance[2 * i], radiance[2 * i + 1]);
            let jump: Rgb =
                std::array::from_fn(|c| (before[c] - after[c]) * candidate.count as f32);
            if jump.iter().any(|j| !j.is_finite()) {
                counts.not_finite += 1;
            } else if jump != [0.0; 3] {
                let Candidate {
                    boundary, axis, at, ..
                } = *candidate;
                found.push(FilmCrossing {
                    boundary,
                    axis: axis as u8,
                    at,
                    jump,
                });
            }
        }
    }
    found
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
