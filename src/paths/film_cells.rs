//! What the camera sees: where the radiance jumps along the rows and columns of a tile's lattice.
//!
//! The same cells as for light (`super::light_cells`), on the film: between two neighbours of a lattice row the
//! interval of film is shifted rigidly with the silhouette that lies in it, and what is left of the change of
//! variables are the radiances at its two ends, L₋ − L₊, times the silhouette's speed. Rows give the speed's part along
//! x, columns the part along y. The pixel filter multiplies the jump *where the silhouette is*: it is neither moved nor
//! differentiated, so a box filter is as good as a smooth one, and no kernel blurs the image.

use super::lattice::Tile;
use super::store::FilmCrossing;
use super::tracer::Tracer;
use crate::scene::Rgb;
use crate::trace::geometry::NO_TRIANGLE;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::{Boundary, dvec3};
use crate::warp::resolve::{Between, between};
use crate::warp::walk::{Arc, Fold};

/// What the lattice of a tile saw: row by row.
pub struct LatticeImage {
    pub triangle: Vec<u32>,
    pub radiance: Vec<Rgb>,
}

/// Appends the crossings between all neighbours whose radiances differ and of which `moves(a, b)` says that the
/// boundary between the two triangles can move.
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    tile: &Tile,
    image: &LatticeImage,
    moves: impl Fn(u32, u32) -> bool,
    unresolved: &mut u64,
    out: &mut Vec<FilmCrossing>,
) {
    let [columns, rows] = tile.points;
    let origin = tracer.camera.origin.as_dvec3();
    let per_pixel = tracer.camera.direction_per_pixel();
    for axis in 0..2 {
        let stride = if axis == 0 { 1 } else { columns };
        for row in 0..rows - axis {
            for column in 0..columns - (1 - axis) {
                let inner = if axis == 0 { tile.is_inner(1, row) } else { tile.is_inner(0, column) };
                let at = row * columns + column;
                let (a, b) = (image.triangle[at], image.triangle[at + stride]);
                let (before, after) = (image.radiance[at], image.radiance[at + stride]);
                if !inner || a == b || before == after || !moves(a, b) {
                    continue;
                }
                let start = [tile.position(0, column), tile.position(1, row)];
                let mut end = start;
                end[axis] += tile.step[axis];
                let direction = |[u, v]: [f64; 2]| dvec3(tracer.camera.direction(u, v));
                let arc = Arc { origin, a: direction(start), b: direction(end) };
                let (boundary, s) = match between(tracer.geometry, adjacency, &arc, a, b) {
                    Between::Nothing => continue,
                    Between::Unresolved => {
                        *unresolved += 1;
                        continue;
                    }
                    Between::Crease { boundary, s } => (boundary, s),
                    Between::Silhouette(fold) => (Boundary::Edge(fold.edge), fold.s),
                    Between::Ridge(Fold { edge, along, s, .. }) => {
                        (Boundary::Point { edge, along, line: per_pixel[1 - axis] }, s)
                    }
                };
                let mut film = start;
                film[axis] += s * tile.step[axis];
                if tile.contains(film[0], film[1]) {
                    let jump = std::array::from_fn(|c| before[c] - after[c]);
                    out.push(FilmCrossing { boundary, axis: axis as u8, at: film, jump });
                }
            }
        }
    }
}

/// The mesh of a triangle, if there is one.
pub fn mesh_of(tracer: &Tracer, triangle: u32) -> Option<usize> {
    (triangle != NO_TRIANGLE).then(|| tracer.geometry.mesh_of_triangle[triangle as usize] as usize)
}
