//! What the camera sees: where the radiance jumps along the rows and columns of a tile's lattice.
//!
//! The same cells as for light (`boundary::cells::light`), on the film: between two neighbours of a
//! lattice row the interval of film is shifted rigidly with the silhouette that lies in it, and
//! what the change of variables leaves is the jump of the radiance times the silhouette's speed.
//! Rows give the speed's part along x, columns the part along y. The pixel filter multiplies the
//! jump *where the silhouette is*: it is neither moved nor differentiated, so a box filter is as
//! good as a smooth one (`super::piece`), and no kernel blurs the image.
//!
//! The jump is L₋ − L₊ right beside the silhouette, from one ray on either side or more. The two
//! share their random numbers, as a correlated pair: at an edge of a flat-shaded surface both see
//! the same light sample, and only the normals differ.

use super::cell::{FilmCell, LatticeCells, LatticeLine};
use super::crowds::Crowds;
use super::piece::pieces;
use super::weights::{self, ROUNDS};
use super::{looks, rims, shadow_border, shadows, terminators};
use crate::boundary::cells::chain;
use crate::boundary::cells::line_search::{Candidate, LineSearch, Look, Met};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::{Boundary, velocity_per_side};
use crate::lanes::{Lane, V3};
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN, Piece};
use crate::paths::counts::Counts;
use crate::paths::dimensions::{Branch, Single};
use crate::paths::estimator::FilmTile;
use crate::paths::random::Stream;
use crate::paths::start::Start;
use crate::trace::Coherence;
use glam::DVec3;
use std::collections::BTreeSet;

/// Of the cells about which all looks alike one in this many is searched and stands for all, but
/// in crowds.
const UNLIKELY: u32 = 8;

/// Finds what jumps between all neighbours between which something that moves may be seen.
pub fn find(scene: &SearchScene, film: &FilmTile, out: &mut Found) {
    let cells = LatticeCells { scene, film };
    let mut search = LineSearch::new(scene, &mut out.counts);
    let mut crowds = Crowds::new(cells);
    let (mut candidates, skipped) = searched_cells(&cells, &mut crowds, &mut search);
    for candidate in &mut candidates {
        let Candidate { crossing, cell, .. } = candidate;
        if crossing.is_silhouette() && crowds.contain(cell.position(0.0), search.counts) {
            cell.crowd();
        }
    }
    let view = film.view;
    for _ in 0..ROUNDS {
        candidates = search.see(&candidates, |directions, active| {
            let rays = view.camera.rays_along(directions, active);
            view.intersect(&rays, Coherence::Coherent)
        });
        if candidates.is_empty() {
            break;
        }
    }
    search
        .met
        .retain(|met| film.tile.contains(met.at.cell.position(met.at.crossing.s)));
    let chances = weights::chances(&cells, &mut search, &skipped);
    let samples = film.image.radiance.len();
    let many = looks::many(&search.met, &chances, samples, film.tile.points);
    let once = search.met.iter().zip(&many).map(|(met, many)| {
        let number = met.at.cell.numbers;
        number..number + u32::from(many.is_empty())
    });
    let once: Vec<_> = once.collect();
    let stream = film.tile.stream.branch(Branch::FilmProbe, [0; 3]);
    let of_many = film.tile.stream.branch(Branch::FilmLook, [0; 3]);
    for (looks, stream) in [(&once, &stream), (&many, &of_many)] {
        search.look(looks, |beside, counts| look(&cells, beside, stream, counts));
    }
    let LineSearch { met, counts, .. } = search;
    for (met, chance) in met.iter().zip(chances) {
        add(&cells, met, chance, (&mut crowds, counts), &mut out.samples);
    }
    chain::film::find(&cells, &stream, out);
    if film.image.hidden.is_empty() {
        return;
    }
    let mut borders = Vec::new();
    shadows::find(&cells, &mut borders, &mut out.counts);
    terminators::find(&cells, &mut borders, &mut out.counts);
    rims::find(&cells, &mut borders, &mut out.counts);
    shadow_border::add(&cells, &borders, out);
}

/// Searches the cells of a tile, and says which were left out.
fn searched_cells<'a>(
    cells: &LatticeCells<'a>,
    crowds: &mut Crowds,
    search: &mut LineSearch<FilmCell<'a>>,
) -> (Vec<Candidate<FilmCell<'a>>>, BTreeSet<(LatticeLine, i64)>) {
    let FilmTile {
        view, tile, image, ..
    } = *cells.film;
    let [columns, rows] = tile.points;
    let mut candidates = Vec::new();
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
                let (point, next) = (cells.index(line, at), cells.index(line, at + 1));
                let (a, b) = (image.triangle[point], image.triangle[next]);
                let differ = a != b || view.geometry.has_texture_edges(a);
                if !tile.is_inner(1 - axis, number) || !differ {
                    continue;
                }
                if !cells.moves(line, at) {
                    skipped.insert((line, at as i64));
                    continue;
                }
                let number = (axis * columns * rows + point) as u32;
                let mut choice = tile.stream.single(Single::FilmEdge, [number, 0, 0]) as f64;
                // Equal radiances all about mostly mean that there is no jump, unless all are in
                // shadow. The ends alone say little where paths see one of two things.
                let mut weight = 1;
                let radiance = image.radiance[point];
                let ends = [at, at + 1].map(|at| cells.direction(line, at as f64));
                let is_unlikely = cells.looks_alike(line, at)
                    && radiance != [0.0; 3]
                    && (cells.goes_on(ends, [a, b])
                        || !crowds.contain(cells.position(line, at as i64), search.counts));
                if is_unlikely {
                    weight = UNLIKELY;
                    choice *= UNLIKELY as f64;
                }
                if choice >= 1.0 {
                    skipped.insert((line, at as i64));
                    continue;
                }
                let mut cell = cells.cell(line, at as i64, search.counts);
                (cell.weight, cell.numbers) = (weight, number);
                candidates.extend(search.candidates(&cell, Some(choice)));
            }
        }
    }
    (candidates, skipped)
}

/// The radiance that a packet of looks sees.
fn look(cells: &LatticeCells, beside: &Look, stream: &Stream, counts: &mut Counts) -> V3<Lane> {
    let sides = beside.sides;
    let camera = &cells.film.view.camera;
    let rays = camera.rays_along(&beside.directions, sides.active);
    let start = Start {
        seen: Some(beside.seen),
        ..Start::of_rays(rays, 0)
    };
    let (radiance, _) = cells
        .scene
        .probe(start, sides, stream, &beside.numbers, counts);
    radiance
}

/// Adds the jump times the silhouette's speed per unit of Ḟ along the line, over the lines'
/// density. In a crowd the speed is that of the point of the edge.
fn add<'a>(
    cells: &LatticeCells<'a>,
    met: &Met<FilmCell>,
    chance: f64,
    (crowds, counts): (&mut Crowds<'a>, &mut Counts),
    samples: &mut Vec<BoundarySample>,
) {
    if met.jump == DVec3::ZERO {
        return;
    }
    let Candidate { crossing, cell, .. } = &met.at;
    let FilmTile { view, tile, .. } = *cells.film;
    let axis = cell.axis();
    let at = cell.position(crossing.s);
    let origin = view.camera.eye();
    let per_pixel = view.camera.direction_per_pixel();
    let mut boundary = crossing.boundary;
    if crowds.contain(at, counts) {
        let direction = cells.direction_at(at);
        boundary = boundary.of_point(view.geometry, origin, direction, per_pixel[1 - axis]);
    }
    let gradient = |boundary: &Boundary| {
        let c = boundary.normal(view.geometry, origin);
        per_pixel.map(|d| c.dot(d))
    };
    let own = gradient(&boundary);
    if velocity_per_side(own, [1.0, 0.0, 1.0], axis).is_none() {
        return;
    }
    let across = tile.step[1 - axis];
    let keep = |boundary: Boundary, at: [f64; 2], piece: Piece| {
        let boundary = boundary.standing(view.geometry, met.seen);
        let velocity = velocity_per_side(gradient(&boundary), [1.0, 0.0, 1.0], axis);
        // An edge that is seen end-on has no length.
        let weight = met.jump * (velocity.unwrap_or(0.0) * across / chance);
        samples.push(BoundarySample {
            boundary,
            shadow: None,
            lane: 0,
            at: Coordinate::Film { at, piece },
            chain: NO_CHAIN,
            weight: weight.as_vec3().to_array(),
            jump: (met.jump.length() / met.at.crossing.count) as f32,
        });
    };
    let crossing = (crossing, &boundary);
    pieces((cells, crowds), crossing, (at, own), axis, counts, keep);
}
