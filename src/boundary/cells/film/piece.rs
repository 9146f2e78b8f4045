//! The piece of an edge that its crossing with a row or a column stands for.
//!
//! Rows are one step h apart. A straight edge is covered once, without gaps, by pieces about its
//! crossings that reach half a step to both sides, across the rows. Before a filter that jumps from
//! pixel to pixel, such as a box, the share of a pixel in an edge is then its length there. With points
//! in place of pieces it would be a number of crossings, and off by a good part of one.
//!
//! At an end of the edge the rest of the piece is folded back onto the edge. A point at a distance t <
//! h/2 from the end is then met by the crossings up to h/2 + t beyond it and, folded, by those up to
//! h/2 − t: by as many as elsewhere. So is any edge, however short: if it has a length of ℓ across the
//! rows there is a crossing with the chance ℓ/h, whose piece has the density h/ℓ.
//!
//! Where velocities are told otherwise on the other side, at the borders of a tile and of crowds, it is
//! folded back as well.
//!
//! In the mean over the lattice's shifts every point of the edge counts once, with its own velocity and
//! its own place on the film. What jumps there is that of the crossing: it is the mean over a step along
//! the edge, which is off by h²/24 times the second derivative along it, and by less than a step where
//! something hides the edge.

use super::crowds::Crowds;
use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Piece;
use crate::paths::counts::Counts;
use crate::paths::estimator::FilmTile;

/// No piece reaches further than this along its row or column, in pixels: those that cross flatly
/// have hardly any weight.
const LONGEST: f64 = 1.0;

/// The piece about the place `at` where a boundary crosses a line along `axis`, with ∇F on the film
/// there. A point for what is no edge, and before a filter
/// without jumps, whose weights sum up well over points.
pub fn piece(
    (film, crowds): (&FilmTile, &mut Crowds),
    boundary: &Boundary,
    (at, gradient): ([f64; 2], [f64; 2]),
    axis: usize,
    counts: &mut Counts,
) -> Piece {
    let &Boundary::Edge(vertices) = boundary else {
        return Piece::POINT;
    };
    if film.filter.is_continuous() {
        return Piece::POINT;
    }
    let (tile, view) = (film.tile, film.view);
    let across = 1 - axis;
    let slope = -gradient[across] / gradient[axis];
    // A shorter piece about every crossing covers the edge as often in the mean.
    let reach = (0.5 * tile.step[across]).min(LONGEST / slope.abs());
    let mut half = [reach; 2];
    half[axis] = slope * reach;
    let mut ends = [f64::NEG_INFINITY, f64::INFINITY];
    for vertex in vertices {
        let point = view.geometry.positions[vertex as usize].as_dvec3();
        // An edge that goes on behind the camera has no end on the film.
        if view.camera.is_before(point) {
            let end = (view.camera.film_point(point)[across] - at[across]) / reach;
            ends[usize::from(end > 0.0)] = end;
        }
    }
    for i in (0..2).filter(|i| half[*i] != 0.0) {
        let borders = [tile.start[i], tile.end[i]].map(|b| (f64::from(b) - at[i]) / half[i]);
        ends[0] = ends[0].max(borders[0].min(borders[1]));
        ends[1] = ends[1].min(borders[0].max(borders[1]));
    }
    ends[0] = ends[0].max(-crowds.free_way(at, half.map(|h| -h), counts));
    ends[1] = ends[1].min(crowds.free_way(at, half, counts));
    Piece { half, ends }
}
