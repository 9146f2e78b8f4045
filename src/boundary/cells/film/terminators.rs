//! Where smooth surfaces turn away from delta lights along the rows and columns of a tile's
//! lattice.
//!
//! Over an edge of a mesh with shading normals shading goes on, but the plane of the triangles does
//! not: a light that lies between the two planes is seen from one of them alone. Such edges are
//! few, and which they are is known without a ray, so that all of them are looked at. (From among
//! the other edges in a cell one is drawn at random.)

use super::cell::{LatticeCells, LatticeLine};
use super::shadow_border::{Border, SMALLEST_CHANCE, between};
use crate::boundary::cells::delta::follow::{Rays, step, surface, surface_end};
use crate::boundary::cells::delta::receiver::Receiver;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::facets::Facet;
use crate::paths::boundary_sample::Shadow;
use crate::paths::counts::Counts;
use crate::paths::estimator::FilmTile;
use crate::trace::geometry::NO_TRIANGLE;

/// Finds the edges that move at which a surface turns away from a light.
pub fn find(cells: &LatticeCells, borders: &mut Vec<Border>, counts: &mut Counts) {
    let FilmTile {
        tile, image, view, ..
    } = *cells.film;
    let geometry = view.geometry;
    if geometry.normals.is_empty() {
        return;
    }
    for axis in 0..2 {
        for number in 1..tile.points[1 - axis] - 1 {
            let line = LatticeLine { axis, number };
            for at in 0..tile.points[axis] - 1 {
                let seen = [at, at + 1].map(|at| image.triangle[cells.index(line, at)]);
                if seen[0] == seen[1] {
                    continue;
                }
                let is_smooth = |t: u32| {
                    t != NO_TRIANGLE
                        && geometry.smooth[geometry.mesh_of_triangle[t as usize] as usize]
                };
                let points = [at as i64, at as i64 + 1];
                for (points, start) in [(points, seen[0]), ([points[1], points[0]], seen[1])] {
                    if !is_smooth(start) || !moves(cells, line, at, start) {
                        continue;
                    }
                    if from_point(cells, line, points, borders, counts) {
                        break;
                    }
                }
            }
        }
    }
}

/// Whether the edges of a surface move.
fn moves(cells: &LatticeCells, line: LatticeLine, at: usize, triangle: u32) -> bool {
    let geometry = cells.scene.view.geometry;
    let [vertex, _, _] = geometry.triangles[triangle as usize];
    cells
        .scene
        .moving
        .boundary(geometry, &Boundary::Edge([vertex; 2]))
        || cells.film.drifts(cells.position(line, at as i64))
}

/// Looks for such edges from what is seen at a point of a line toward one beside it. Says whether
/// both see one surface.
fn from_point(
    cells: &LatticeCells,
    line: LatticeLine,
    points @ [from, to]: [i64; 2],
    borders: &mut Vec<Border>,
    counts: &mut Counts,
) -> bool {
    let scene = cells.scene;
    let rays = between(cells, line, points, counts);
    let (end, passed) = surface(scene, &rays, 1.0, counts);
    let (geometry, adjacency) = (scene.view.geometry, scene.adjacency);
    let mut chance = None;
    for pair in passed.windows(2) {
        let Some(edge) = pair[0].bend(geometry, adjacency) else {
            continue;
        };
        for light in 0..scene.view.delta_lights.len() {
            let jump = turn(cells, light, &rays, pair, counts);
            let along = (to - from) as f64;
            let mut at = cells.position(line, from);
            at[line.axis] += pair[0].to * along * cells.film.tile.step[line.axis];
            if jump == 0.0 || !cells.film.tile.contains(at) {
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
            let facing = pair[usize::from(jump < 0.0)];
            borders.push(Border {
                boundary: Boundary::Edge(edge),
                shadow: Shadow {
                    light: light as u32,
                    receiver: facing.triangle,
                },
                is_own: true,
                axis: line.axis,
                at,
                lit_side: 0.0,
                jump: jump * along / chance,
            });
        }
    }
    end >= 1.0
}

/// Of two triangles, 1 if only the first sees the light, −1 if only the second does, and 0 else;
/// where one of them faces it and the other does not.
fn turn<F>(
    cells: &LatticeCells,
    light: usize,
    rays: &Rays<F>,
    pair: &[Facet],
    counts: &mut Counts,
) -> f64 {
    let Rays { arc, .. } = rays;
    let s = pair[0].to;
    let receivers = [0, 1].map(|i| Receiver::new(cells.scene, light, pair[i].triangle));
    let direction = arc.direction(s);
    let x = receivers[0].point(arc.origin, direction);
    let [first, second] = [0, 1].map(|i| receivers[i].faces_light(x, direction));
    if first == second {
        return 0.0;
    }
    const NEAR: f64 = 1e-3;
    let near = receivers[0].point(arc.origin, arc.direction(s - NEAR));
    let beside = step(cells.scene.view.geometry, x, near.distance(x) / NEAR);
    let sees = [(0, -beside), (1, beside)].map(|(i, beside)| {
        let y = receivers[i].point(arc.origin, arc.direction(s + beside));
        counts.probe += 1;
        f64::from(receivers[i].occluder(y) == NO_TRIANGLE)
    });
    sees[0] - sees[1]
}
