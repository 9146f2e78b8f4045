//! Edges on the film: points are drawn along what the camera would see of them if nothing stood
//! before, at equal distances up to jitter.
//!
//! With ℓ the length of a tile's edges in pixels and n points, a point stands for ℓ/n pixels of
//! border. Borders move across themselves by −Ḟ/|∇F|, and bring (L₋ − L₊) times that (`docs/
//! method.md`, eq. 2). Of edges at which only the planes of facets differ fewer points are drawn,
//! and each stands for more.

use super::point::{explains, is_at, kind};
use super::set::EdgeSet;
use super::sources::Edges;
use super::tile_edges::FilmEdge;
use crate::boundary::occlusion::probe_angle;
use crate::boundary::probe::Sides;
use crate::discontinuity::boundary::{Boundary, dvec3};
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::lanes::LANES;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN, Piece};
use crate::paths::dimensions::{Branch, Single};
use crate::paths::estimator::FilmTile;
use crate::paths::rays::lane_of;
use crate::paths::start::Start;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec2, DVec3};

/// Points for each step of the lattice that the edges are long: about as many as its rows and
/// columns cross.
const POINTS_PER_STEP: f64 = 1.3;
/// Of points of a tile's samples, so many may be drawn on edges.
const MOST_POINTS: f64 = 2.0;
/// Probes look no farther beside an edge than this, in pixels.
const MOST_BESIDE: f64 = 1e-3;
/// What is nearer than this part of the way to an edge stands before it.
const BEFORE: f64 = 1.0 - 1e-4;

/// A point of an edge on the film.
struct FilmPoint {
    at: DVec2,
    boundary: Boundary,
    crossing: Crossing,
    /// ∇F, per pixel.
    slope: DVec2,
    /// Toward the point on the edge, of full length.
    way: DVec3,
    /// How far beside it probes look, in pixels.
    beside: f64,
    /// The length that it stands for, in pixels.
    length: f64,
}

/// Finds what jumps at points on the edges of a tile.
// Long: draws, looks and keeps, in the order of the points.
pub fn find(edges: &Edges, film: &FilmTile, out: &mut Found) {
    let (view, tile) = (film.view, film.tile);
    // A camera that moves makes all edges move.
    let Some(set) = edges.set(view, false) else {
        return;
    };
    let in_tile = edges.in_tile(set, film);
    let Some(&total) = in_tile.cumulative.last() else {
        return;
    };
    let step = tile.step[0].max(tile.step[1]);
    let samples = (tile.points[0] * tile.points[1]) as f64;
    let count = (POINTS_PER_STEP * total / step)
        .min(MOST_POINTS * samples)
        .ceil();
    let mut points = Vec::new();
    for number in 0..count as u32 {
        let jitter = f64::from(tile.stream.single(Single::FilmEdgePoint, [number, 0, 0]));
        let place = (f64::from(number) + jitter) / count * total;
        let which = in_tile.cumulative.partition_point(|&sum| sum <= place);
        let which = which.min(in_tile.edges.len() - 1);
        let edge = &in_tile.edges[which];
        let below = if which == 0 {
            0.0
        } else {
            in_tile.cumulative[which - 1]
        };
        let own = in_tile.cumulative[which] - below;
        let along = ((place - below) / own).clamp(0.0, 1.0);
        let length = total / (count * edge.importance);
        points.extend(FilmPoint::new(set, film, edge, along, length));
    }
    let scene = edges.scene(view);
    let stream = tile.stream.branch(Branch::FilmEdgeProbe, [0; 3]);
    let mut number = 0;
    for group in points.chunks(LANES) {
        let seen = visible(film, group, out);
        let kept: Vec<&FilmPoint> = group
            .iter()
            .enumerate()
            .filter(|(lane, _)| seen >> lane & 1 == 1)
            .map(|(_, point)| point)
            .collect();
        for pair in kept.chunks(LANES / 2) {
            let mut directions = [DVec3::Z; LANES];
            let mut sides = Sides::default();
            for (i, point) in pair.iter().enumerate() {
                for (k, side) in [-1.0, 1.0].into_iter().enumerate() {
                    let at = point.at + point.slope.normalize() * (side * point.beside);
                    directions[2 * i + k] = dvec3(view.camera.direction(at.x, at.y));
                }
                sides.add(i, point.crossing.kind == Kind::FacetEdge);
            }
            let rays = view.camera.rays_along(&directions, sides.active);
            let start = Start::of_rays(rays, 0);
            // Both sides share their random numbers.
            let index = std::array::from_fn(|lane| number + (lane / 2) as u32);
            number += pair.len() as u32;
            let (radiance, triangles) = scene.probe(start, sides, &stream, &index, &mut out.counts);
            for (i, point) in pair.iter().enumerate() {
                let lanes = [2 * i, 2 * i + 1];
                let seen = lanes.map(|l| triangles[l]);
                if point.crossing.is_hidden(seen) || !explains(view.geometry, &point.crossing, seen)
                {
                    continue;
                }
                let [before, after] = lanes.map(|l| lane_of(radiance, l).as_dvec3());
                let origin = view.camera.origin.as_dvec3();
                let (boundary, per_line) =
                    (point.boundary).standing_seen_from(view.geometry, origin, seen);
                let length = point.length * per_line / point.slope.length();
                let brings = (after - before) * length;
                if !brings.is_finite() {
                    out.counts.boundary_not_finite += 1;
                } else if brings != DVec3::ZERO {
                    out.samples.push(BoundarySample {
                        chain: NO_CHAIN,
                        boundary,
                        lane: 0,
                        at: Coordinate::Film {
                            at: point.at.to_array(),
                            piece: Piece::POINT,
                        },
                        weight: brings.as_vec3().to_array(),
                        jump: (after - before).length() as f32,
                        shadow: None,
                    });
                }
            }
        }
    }
}

impl FilmPoint {
    fn new(
        set: &EdgeSet,
        film: &FilmTile,
        on_film: &FilmEdge,
        along: f64,
        length: f64,
    ) -> Option<Self> {
        let view = film.view;
        let (camera, geometry) = (&view.camera, view.geometry);
        let origin = camera.origin.as_dvec3();
        let edge = &set.edges.edges[on_film.edge as usize];
        let at = on_film.ends[0].lerp(on_film.ends[1], along);
        let boundary = Boundary::Edge(edge.ends);
        let c = boundary.normal(geometry, origin);
        let per_pixel = camera.direction_per_pixel();
        let slope = DVec2::from(per_pixel.map(|d| c.dot(d)));
        let across = slope.try_normalize()?;
        let d = dvec3(camera.direction(at.x, at.y));
        let crossing = Crossing::new(boundary, kind(edge, on_film.open_side), 0.0);
        let [angle, _] = probe_angle(geometry, &crossing, (origin, 0.0), d);
        let per_pixel = per_pixel[0] * across.x + per_pixel[1] * across.y;
        let angle_per_pixel = d.cross(per_pixel).length() / d.length_squared();
        let beside = (angle / angle_per_pixel).min(MOST_BESIDE);
        let way = boundary.seen_along(geometry, origin, d)? - origin;
        let shift = on_film.open_side.unwrap_or(0.0) * beside * way.length() / d.length();
        let found = Self {
            at,
            boundary,
            crossing,
            slope,
            way: way + per_pixel * shift,
            beside,
            length: edge.share * length,
        };
        (found.way.is_finite() && beside.is_finite()).then_some(found)
    }
}

/// The points before which nothing stands.
fn visible(film: &FilmTile, points: &[FilmPoint], out: &mut Found) -> u32 {
    let view = film.view;
    let camera = &view.camera;
    let ahead = camera.axes[2].as_dvec3();
    // As long as the camera's own rays, which are cut off near and far.
    let directions: [DVec3; LANES] = std::array::from_fn(|lane| match points.get(lane) {
        Some(point) => point.way / point.way.dot(ahead),
        None => ahead,
    });
    let active = u32::MAX >> (32 - points.len());
    let rays = camera.rays_along(&directions, active);
    out.counts.edge += points.len() as u64;
    let seen = view.intersect(&rays, Coherence::Incoherent);
    let is_before = |lane: usize| {
        if is_at(view.geometry, &points[lane].boundary, seen[lane]) {
            return false;
        }
        let corners = view.geometry.triangles[seen[lane] as usize];
        let [a, b, c] = corners.map(|v| view.geometry.positions[v as usize].as_dvec3());
        let n = (b - a).cross(c - a);
        let distance = n.dot(a - camera.origin.as_dvec3()) / n.dot(directions[lane]);
        distance < BEFORE * points[lane].way.dot(ahead)
    };
    (0..points.len())
        .filter(|&lane| seen[lane] == NO_TRIANGLE || !is_before(lane))
        .fold(0, |bits, lane| bits | 1 << lane)
}
