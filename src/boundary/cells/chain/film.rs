//! What the camera sees through smooth surfaces: lines of the film's lattice that meet one.

use super::follow::{FirstRays, Followed, normal_through};
use super::look::jumps;
use super::search::{ChainSearch, Found as Border};
use crate::boundary::cells::film::cell::{LatticeCells, LatticeLine};
use crate::discontinuity::boundary::{dvec3, velocity_per_side};
use crate::lanes::LANES;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, Piece};
use crate::paths::dimensions::Single;
use crate::paths::estimator::FilmTile;
use crate::paths::random::Stream;
use glam::DVec3;

/// A border, and the line on which it was found.
struct OnLine {
    border: Border,
    line: LatticeLine,
}

/// The rays of a line of the film's lattice, by steps from its first point.
struct LineRays<'a> {
    cells: &'a LatticeCells<'a>,
    line: LatticeLine,
}

impl LineRays<'_> {
    fn position(&self, s: f64) -> [f64; 2] {
        let LatticeLine { axis, .. } = self.line;
        let mut position = self.cells.position(self.line, 0);
        position[axis] += s * self.cells.film.tile.step[axis];
        position
    }
}

impl FirstRays for LineRays<'_> {
    fn ray(&self, s: f64) -> (DVec3, DVec3) {
        let [u, v] = self.position(s);
        let (origin, direction) = self.cells.scene.view.camera.ray(u, v);
        (dvec3(origin), dvec3(direction))
    }

    fn chance_between(&self, [from, to]: [f64; 2]) -> f64 {
        (to - from).min(1.0)
    }

    fn place(&self, s: f64) -> f64 {
        s
    }

    fn at_place(&self, place: f64) -> f64 {
        place
    }

    fn moves(&self, s: f64) -> bool {
        self.cells.film.drifts(self.position(s))
    }

    fn reach(&self) -> [f32; 2] {
        let camera = &self.cells.scene.view.camera;
        [camera.near_clip, camera.far_clip]
    }
}

/// Finds what jumps behind smooth surfaces. `stream` has the random numbers of what looks beside
/// it.
pub fn find(cells: &LatticeCells, stream: &Stream, out: &mut Found) {
    let FilmTile { view, tile, .. } = *cells.film;
    if !view.materials.any_chains {
        return;
    }
    let [columns, rows] = tile.points;
    let mut borders = Vec::new();
    for axis in 0..2 {
        for number in 0..[rows, columns][axis] {
            if tile.is_inner(1 - axis, number) {
                find_on_line(cells, LatticeLine { axis, number }, out, &mut borders);
            }
        }
    }
    borders.sort_by_key(|b| b.border.kind());
    let by_length = borders.chunk_by(|a, b| a.border.kind() == b.border.kind());
    for group in by_length.flat_map(|group| group.chunks(LANES / 2)) {
        let all: Vec<&Border> = group.iter().map(|b| &b.border).collect();
        let number = |b: &OnLine| {
            let point = cells.index(b.line, b.border.s.max(0.0) as usize);
            (b.line.axis * columns * rows + point) as u32
        };
        let index = std::array::from_fn(|l| group.get(l / 2).map_or(0, number));
        let jumps = jumps(cells.scene, &all, 0, (stream, &index), &mut out.counts);
        for (found, jump) in group.iter().zip(jumps) {
            add(cells, found, jump, out);
        }
    }
}

/// Finds the borders on one line: on those stretches of it whose points see smooth surfaces.
fn find_on_line(
    cells: &LatticeCells,
    line: LatticeLine,
    out: &mut Found,
    borders: &mut Vec<OnLine>,
) {
    let FilmTile {
        view, tile, image, ..
    } = *cells.film;
    let rays = LineRays { cells, line };
    let seen: Vec<u32> = (0..tile.points[line.axis])
        .map(|at| image.triangle[cells.index(line, at)])
        .collect();
    let is_smooth = |at: usize| Followed::is_smooth(view, seen[at]);
    let number = (line.axis << 16 | line.number) as u32;
    let mut stretch = Vec::new();
    for at in 0..seen.len() {
        let is_last = at + 1 == seen.len();
        let is_near = is_smooth(at) || (at > 0 && is_smooth(at - 1));
        if is_near || (!is_last && is_smooth(at + 1)) {
            stretch.push(Followed::first(&rays, at as f64, seen[at]));
            if !is_last {
                continue;
            }
        }
        if stretch.len() > 1 {
            let first = stretch[0].s as u32;
            let random =
                |name| f64::from(tile.stream.single(Single::FilmChain, [number, first, name]));
            let mut search = ChainSearch {
                scene: cells.scene,
                rays: &rays,
                counts: &mut out.counts,
                random: &random,
                drawn: 0,
                depth: 0,
                splits_first: true,
                new_points: None,

                waiting: Vec::new(),
                found: Vec::new(),
            };
            search.search(std::mem::take(&mut stretch));
            let found = search.found.into_iter();
            let found = found.filter(|b| tile.contains(rays.position(b.s)));
            borders.extend(found.map(|border| OnLine { border, line }));
        }
        stretch.clear();
    }
}

/// Keeps what a border brings.
fn add(cells: &LatticeCells, found: &OnLine, jump: DVec3, out: &mut Found) {
    let FilmTile { view, tile, .. } = *cells.film;
    let OnLine { border, line } = found;
    let rays = LineRays { cells, line: *line };
    let position = rays.position(border.s);
    let origin = view.camera.eye();
    let direction = cells.direction_at(position);
    let jumps = (&border.boundary, border.shadow);
    let c = normal_through(view, &border.chain, jumps, origin, direction);
    let gradient = view.camera.direction_per_pixel().map(|d| c.dot(d));
    let Some(velocity) = velocity_per_side(gradient, [1.0, 0.0, 1.0], line.axis) else {
        return;
    };
    let weight = jump * (velocity * tile.step[1 - line.axis]);
    if jump == DVec3::ZERO || !weight.is_finite() {
        return;
    }
    let chain = out.add_chain(&border.chain);
    out.samples.push(BoundarySample {
        shadow: border.shadow,
        boundary: border.boundary,
        lane: 0,
        at: Coordinate::Film {
            at: position,
            piece: Piece::POINT,
        },
        chain,
        weight: weight.as_vec3().to_array(),
        jump: (jump.length() / border.times()) as f32,
    });
}
