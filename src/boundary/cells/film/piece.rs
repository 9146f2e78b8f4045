//! The piece of an outline that its crossing with a row or a column stands for.
//!
//! Rows are one step h apart. An outline is covered once, without gaps, by pieces about its
//! crossings that reach half a step to both sides, across the rows. Before a filter that jumps from
//! pixel to pixel, such as a box, the share of a pixel in an edge is then its length there. With
//! points in place of pieces it would be a number of crossings, and off by a good part of one.
//!
//! Where an edge ends a piece goes on over the next one of the outline (`discontinuity::outline`),
//! if that leads further across the rows and nearly straight on. If not, the rest of the piece is
//! folded back. Of a chain of edges between two such ends, a point at a distance t < h/2 from an
//! end is met by the crossings up to h/2 + t beyond it and, folded, by those up to h/2 − t: by as
//! many as elsewhere. So is any chain, however short: if it has a length of ℓ across the rows there
//! is a crossing with the chance ℓ/h, whose piece has the density h/ℓ. That holds as long as all
//! crossings of a chain have pieces of one length, and a piece goes over from one edge to another
//! if those of that one come back.
//!
//! Where velocities are told otherwise on the other side, at the borders of crowds, it is folded
//! back as well, and at the border of the film. Over the borders of tiles the lattice goes on.
//!
//! In the mean over the lattice's shifts every point of an outline counts once, with its own
//! velocity and its own place on the film. What jumps there is that of the crossing: it is the mean
//! over a step along the outline, which is off by h²/24 times the second derivative along it, and
//! by less than a step where something hides the outline.

use super::cell::LatticeCells;
use super::crowds::Crowds;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::Crossing;
use crate::discontinuity::outline::{self, HalfEdge};
use crate::paths::boundary_sample::Piece;
use crate::paths::counts::Counts;
use glam::DVec2;

/// No piece reaches further than this along its row or column, in pixels: those that cross flatly
/// have hardly any weight.
const LONGEST: f64 = 1.0;
/// The cosine of the angle, on the film, between an edge and one that pieces go on to from it. What
/// jumps may differ from edge to edge, as on a flat-shaded body: the difference of both is then off
/// by h/8 times that of the velocities, which is small where these are those of one point along
/// nearly one normal.
const STRAIGHT: f64 = 0.95;
/// Edges that a piece may go over, or be folded at; the rest of one that would go over more stays
/// in line with the last.
const MOST_EDGES: usize = 16;
/// Of a piece's half, what is no longer worth a stretch.
const LEAST: f64 = 1e-9;

/// An edge on the film: straight, through `at` + s·`half` between two values of s. All of a piece
/// have their `at` on the row of the crossing, and `half` reaches as far across.
#[derive(Clone, Copy)]
struct Line {
    vertices: [u32; 2],
    at: [f64; 2],
    half: [f64; 2],
    ends: [f64; 2],
    /// If pieces may go on from it, and whether its first vertex is the first of the ends.
    edge: Option<(HalfEdge, bool)>,
}

/// What a piece goes over.
struct Course<'a, 'b> {
    cells: &'a LatticeCells<'b>,
    crowds: &'a mut Crowds<'b>,
    counts: &'a mut Counts,
    axis: usize,
    row: f64,
    reach: f64,
}

/// Calls with the stretches of the piece about the place `at` where a boundary crosses a line along
/// `axis`, with ∇F on the film there: with the edge that each is of, and a place that its piece is
/// about. A point for what is no edge, and before a filter without jumps, whose weights sum up well
/// over points.
pub fn pieces<'b>(
    (cells, crowds): (&LatticeCells<'b>, &mut Crowds<'b>),
    (crossing, boundary): (&Crossing, &Boundary),
    (at, gradient): ([f64; 2], [f64; 2]),
    axis: usize,
    counts: &mut Counts,
    mut keep: impl FnMut(Boundary, [f64; 2], Piece),
) {
    let &Boundary::Edge(vertices) = boundary else {
        return keep(*boundary, at, Piece::POINT);
    };
    if cells.film.filter.is_continuous() {
        return keep(*boundary, at, Piece::POINT);
    }
    let across = 1 - axis;
    let slope = -gradient[across] / gradient[axis];
    let whole = 0.5 * cells.film.tile.step[across];
    // A shorter piece about every crossing covers an edge as often in the mean.
    let reach = whole.min(LONGEST / slope.abs());
    let mut course = Course {
        cells,
        crowds,
        counts,
        axis,
        row: at[across],
        reach,
    };
    let mut half = [reach; 2];
    half[axis] = slope * reach;
    let first = Line {
        vertices,
        at,
        half,
        ends: course.ends(vertices),
        edge: None,
    };
    let goes_on = reach == whole && crossing.is_silhouette();
    let first = match goes_on {
        true => course.with_edge(first),
        false => first,
    };
    let mut part = [0.0; 2];
    for (i, way) in [-1.0, 1.0].into_iter().enumerate() {
        let mut is_first = true;
        go(
            first,
            way,
            |line, s, way, rest| course.ahead(line, s, way, rest),
            |line, from, to| match std::mem::take(&mut is_first) {
                true => part[i] = to,
                false => {
                    let (half, part) = (line.half, [from.min(to), from.max(to)]);
                    keep(Boundary::Edge(line.vertices), line.at, Piece { half, part });
                }
            },
        );
    }
    keep(*boundary, at, Piece { half, part });
}

/// Goes a way of one from s = 0, up or down. `ahead` says how far a line is free from s on, and
/// what it goes on with there; if with nothing, one turns back. Calls with each stretch.
fn go<L: Copy>(
    first: L,
    mut way: f64,
    mut ahead: impl FnMut(&L, f64, f64, f64) -> (f64, Option<L>),
    mut keep: impl FnMut(&L, f64, f64),
) {
    let (mut line, mut s, mut rest) = (first, 0.0, 1.0);
    for _ in 0..MOST_EDGES {
        let (free, next) = ahead(&line, s, way, rest);
        let length = free.clamp(0.0, rest);
        keep(&line, s, s + way * length);
        (s, rest) = (s + way * length, rest - length);
        if rest <= LEAST {
            return;
        }
        match next {
            Some(next) => line = next,
            None => way = -way,
        }
    }
    keep(&line, s, s + way * rest);
}

impl Course<'_, '_> {
    /// How far it is to the next end, border or crowd, and what comes behind that.
    fn ahead(&mut self, line: &Line, s: f64, way: f64, rest: f64) -> (f64, Option<Line>) {
        let to_end = ((line.ends[usize::from(way > 0.0)] - s) * way).max(0.0);
        let [start, end] = self.cells.film.tile.film;
        let here = [0, 1].map(|i| line.at[i] + s * line.half[i]);
        let borders = (0..2).filter(|i| line.half[*i] != 0.0).map(|i| {
            let step = way * line.half[i];
            let border = if step > 0.0 { end[i] } else { start[i] };
            (f64::from(border) - here[i]) / step
        });
        let free = borders.fold(to_end.min(rest), f64::min).max(0.0);
        let step = line.half.map(|h| h * way * free);
        let crowd = self.crowds.free_way(here, step, self.counts);
        if crowd < 1.0 {
            return (free * crowd, None);
        }
        match free == to_end && free < rest {
            true => (free, self.next(line, way)),
            false => (free, None),
        }
    }

    /// The next edge of the outline, if that goes on across the rows, and pieces of it as far.
    fn next(&self, line: &Line, way: f64) -> Option<Line> {
        let view = self.cells.film.view;
        let (edge, first_is_low) = line.edge?;
        let mesh = (view.geometry, self.cells.scene.adjacency);
        let origin = view.camera.eye();
        let (edge, starts) = outline::next(mesh, origin, edge, (way < 0.0) == first_is_low)?;
        let vertices = edge.ends(view.geometry);
        let points = vertices.map(|v| view.geometry.positions[v as usize].as_dvec3());
        if !points.iter().all(|p| view.camera.is_before(*p)) {
            return None;
        }
        let [p, q] = points.map(|p| view.camera.film_point(p));
        let across = 1 - self.axis;
        let (rise, run) = (q[across] - p[across], q[self.axis] - p[self.axis]);
        let slope = run / rise;
        let goes_on = (rise * way > 0.0) == starts && rise != 0.0;
        let (mut at, mut half) = ([self.row; 2], [self.reach; 2]);
        at[self.axis] = p[self.axis] + slope * (self.row - p[across]);
        half[self.axis] = slope * self.reach;
        let [old, new] = [line.half, half].map(|h| DVec2::from(h).normalize());
        if !goes_on || (slope * self.reach).abs() > LONGEST || old.dot(new) < STRAIGHT {
            return None;
        }
        Some(Line {
            vertices,
            at,
            half,
            ends: self.ends(vertices),
            edge: Some((edge, rise > 0.0)),
        })
    }

    /// Between which values of s an edge lies. One that goes on behind the camera has no end on the
    /// film.
    fn ends(&self, vertices: [u32; 2]) -> [f64; 2] {
        let view = self.cells.film.view;
        let mut ends = [f64::NEG_INFINITY, f64::INFINITY];
        let points = vertices.map(|v| view.geometry.positions[v as usize].as_dvec3());
        let known = points.map(|point| {
            let is_before = view.camera.is_before(point);
            is_before
                .then(|| (view.camera.film_point(point)[1 - self.axis] - self.row) / self.reach)
        });
        match known {
            [Some(a), Some(b)] => ends = [a.min(b), a.max(b)],
            [Some(end), None] | [None, Some(end)] => ends[usize::from(end > 0.0)] = end,
            [None, None] => {}
        }
        ends
    }

    /// A line that pieces may go on from, if both its ends are seen.
    fn with_edge(&self, line: Line) -> Line {
        let geometry = self.cells.film.view.geometry;
        let edge = self.cells.scene.corners().edge(geometry, line.vertices);
        let camera = &self.cells.film.view.camera;
        let place = |v: u32| geometry.positions[v as usize].as_dvec3();
        let edge = edge.filter(|_| line.vertices.iter().all(|v| camera.is_before(place(*v))));
        let edge = edge.map(|edge| {
            let [p, q] = edge.ends(geometry).map(|v| camera.film_point(place(v)));
            (edge, p[1 - self.axis] < q[1 - self.axis])
        });
        Line { edge, ..line }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pieces about all crossings of a chain of edges with rows cover it evenly, in the mean over
    /// all shifts of the rows; short chains, too.
    #[test]
    fn pieces_cover_a_chain_up_to_its_ends() {
        const SHIFTS: usize = 20_000;
        const BINS: usize = 50;
        for chain in [
            vec![0.0, 1.1],
            vec![0.0, 0.3, 0.35, 2.2],
            vec![0.0, 1.4, 3.0, 3.1],
            vec![0.0, 0.1],
            vec![0.0, 0.05, 0.15],
        ] {
            let whole = *chain.last().expect("ends");
            let bin = whole / BINS as f64;
            let mut covered = [0.0; BINS];
            for k in 0..SHIFTS {
                let row = (k as f64 + 0.5) / SHIFTS as f64 * whole;
                let first = chain.iter().rposition(|end| *end < row).expect("an edge");
                for way in [-1.0, 1.0] {
                    let ahead = |&i: &usize, s: f64, way: f64, _: f64| {
                        let up = way > 0.0;
                        let next = if up { Some(i + 1) } else { i.checked_sub(1) };
                        let next = next.filter(|next| *next < chain.len() - 1);
                        ((chain[i + usize::from(up)] - row - s) * way, next)
                    };
                    go(first, way, ahead, |&i, from, to| {
                        let part = [from.min(to), from.max(to)].map(|s| row + s);
                        assert!(chain[i] - 1e-9 <= part[0] && part[1] <= chain[i + 1] + 1e-9);
                        for (b, sum) in covered.iter_mut().enumerate() {
                            let own = [b, b + 1].map(|b| b as f64 * bin);
                            let common = part[1].min(own[1]) - part[0].max(own[0]);
                            *sum += common.max(0.0) / bin;
                        }
                    });
                }
            }
            // Each crossing has a length of two, spread over a chain of this length.
            for sum in covered {
                let times = sum / SHIFTS as f64 * whole / 2.0;
                assert!((times - 1.0).abs() < 2e-3, "{chain:?}: {times}");
            }
        }
    }
}
