//! A second estimator of boundary terms, through the seam that the first one stands behind.
//!
//! It samples the borders of meshes that the camera sees before an environment that is equally
//! bright everywhere, and knows no cells: what it finds must agree with what they find.

use common::scenes::*;
use common::{Quiet, direction, flat, gradient, settings};
use glam::{DVec2, Vec3, vec3};
use warpath::discontinuity::adjacency::Adjacency;
use warpath::discontinuity::boundary::{Boundary, dvec3};
use warpath::methods::{MakeBoundary, Method, Prepared};
use warpath::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN, Piece};
use warpath::paths::dimensions::Single;
use warpath::paths::estimator::{BoundaryEstimator, FilmTile};
use warpath::scene::{Filter, Scene};
use warpath::statistics::agreement::Agreement;
use warpath::trace::geometry::NO_TRIANGLE;

/// Points on each border.
const POINTS: u32 = 400;
/// How far beside a border it looks, in pixels.
const BESIDE: f64 = 1e-3;
const SKY: f64 = 0.75;
const RUNS: u64 = 64;
const SIGMAS: f64 = 4.0;
/// Standard errors are no more than this part of the gradient.
const RESOLUTION: f64 = 0.01;

struct Borders<'a>(&'a Adjacency);

impl BoundaryEstimator for Borders<'_> {
    fn film(&self, film: &FilmTile, out: &mut Found) {
        for triangle in 0..film.view.geometry.triangles.len() as u32 {
            for corner in (0..3).filter(|&c| self.0.across(triangle, c).is_none()) {
                let vertices = film.view.geometry.triangles[triangle as usize];
                let edge = [vertices[corner], vertices[(corner + 1) % 3]];
                let shift = film
                    .tile
                    .stream
                    .single(Single::FilmEdge, [triangle, corner as u32, 0]);
                let points = (0..POINTS).map(|i| (i as f32 + shift) / POINTS as f32);
                out.samples
                    .extend(points.filter_map(|at| sample(film, edge, at)));
            }
        }
    }
}

/// The jump over |∇F|, times the length of the border that a point stands for.
fn sample(film: &FilmTile, edge: [u32; 2], along: f32) -> Option<BoundarySample> {
    let camera = &film.view.camera;
    let [from, to] = edge.map(|v| film.view.geometry.positions[v as usize]);
    let [at, next] = [along, along + 1e-3].map(|t| on_film(film, from.lerp(to, t)));
    if !film.tile.contains(at.to_array()) {
        return None;
    }
    let length = (next - at).length() * 1e3 / f64::from(POINTS);
    let boundary = Boundary::Edge(edge);
    let c = boundary.normal(film.view.geometry, camera.origin.as_dvec3());
    let slope = DVec2::from(camera.direction_per_pixel().map(|d| c.dot(d)));
    let [before, after] = [-BESIDE, BESIDE].map(|side| {
        let [u, v] = (at + slope.normalize() * side).to_array();
        let d = dvec3(camera.direction(u, v)).as_vec3();
        let sees_sky = film.view.first_hit(camera.origin, d, 0.0, f32::INFINITY) == NO_TRIANGLE;
        if sees_sky { SKY } else { 0.0 }
    });
    Some(BoundarySample {
        boundary,
        shadow: None,
        lane: 0,
        at: Coordinate::Film {
            at: at.to_array(),
            piece: Piece::POINT,
        },
        chain: NO_CHAIN,
        weight: [((after - before) / slope.length() * length) as f32; 3],
        jump: 3f32.sqrt() * (after - before).abs() as f32,
    })
}

/// Where a point is seen.
fn on_film(film: &FilmTile, p: Vec3) -> DVec2 {
    let camera = &film.view.camera;
    let [x, y, z] = camera.axes.map(|axis| axis.dot(p - camera.origin) as f64);
    let (at_zero, at_one) = (
        camera.film_to_camera(0.0, 0.0),
        camera.film_to_camera(1.0, 1.0),
    );
    let (zero, one) = (DVec2::from(at_zero), DVec2::from(at_one));
    (DVec2::new(x, y) / (z * camera.tan_half_x_fov) - zero) / (one - zero)
}

/// A black leaf before the environment.
fn leaf() -> Scene {
    let corner = vec3(-0.5, -0.3, 0.0);
    scene(
        vec3(0.0, 0.0, 3.0),
        Vec3::ZERO,
        40.0,
        [6; 2],
        Filter::Box { radius: 0.5 },
    )
    .constant_environment([SKY as f32; 3])
    .solid(
        "leaf",
        parallelogram(corner, vec3(0.9, 0.2, 0.3), vec3(-0.1, 0.7, 0.0)),
        [0.0; 3],
    )
}

#[test]
fn borders_agree_with_cells() {
    let scene = leaf();
    let by_borders: MakeBoundary = |adjacency, _, _| Box::new(Borders(adjacency));
    for (key, values) in [
        ("leaf.translation", [0.3, 0.4, 1.0]),
        ("leaf.rotation", [0.5, -0.2, 1.0]),
        ("cam.translation", [1.0, 0.3, -0.5]),
    ] {
        let along = direction(&scene, &[(key, &values)]);
        let cells = |seed| gradient(&scene, &settings(&scene, Method::Reparam, 64, seed), &along);
        let borders = |seed| {
            let settings = settings(&scene, Method::Interior, 1, seed);
            let prepared = Prepared::new(&scene, &settings, &|| false).expect("a scene");
            let done = prepared.forward_by(&settings, &along, Some(by_borders), &Quiet);
            flat(&done.expect("a gradient").gradient)
        };
        let cells: Vec<_> = (1..=RUNS).map(cells).collect();
        let borders: Vec<_> = (1..=RUNS).map(borders).collect();
        let agreement = Agreement::new(&cells, &borders);
        assert!(agreement.bias.error < RESOLUTION, "{key}: {agreement:?}");
        assert!(agreement.holds(SIGMAS), "{key}: {agreement:?}");
    }
}
