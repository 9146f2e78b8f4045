//! Gradient images of an edge against its closed form.

use common::scenes::*;
use common::statistics::Estimate;
use common::{direction, gradient, settings};
use glam::{DVec3, Vec3, dvec3, vec3};
use std::f64::consts::PI;
use warpath::methods::Method;
use warpath::scene::{Filter, Scene};

const RUNS: u64 = 64;
const SIGMAS: f64 = 4.0;
/// Standard errors are no more than this part of what they belong to.
const RESOLUTION: f64 = 0.02;

/// Each pixel's derivative (red) in several runs.
fn runs(scene: &Scene, key: &str, values: &[f32], spp: u32) -> Vec<Vec<f64>> {
    let along = direction(scene, &[(key, values)]);
    let run = |seed| gradient(scene, &settings(scene, Method::Reparam, spp, seed), &along);
    (1..=RUNS)
        .map(|seed| run(seed).into_iter().step_by(3).collect())
        .collect()
}

/// Central difference of order 4.
fn derivative(of: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-3;
    (of(-2.0 * h) - 8.0 * of(-h) + 8.0 * of(h) - of(2.0 * h)) / (12.0 * h)
}

// A half-plane before the sky, seen by the camera.
//
// The pixel's value is I_j = L·∫∫ h_j(u, v) [free] du dv over the film, the half-plane being black.
// If the edge is the graph u = e(v; θ) and the sky lies right of it, then dI_j/dθ = −L·∫ h_j(e(v),
// v) ∂e/∂θ dv: an integral along the edge, done here with the midpoint rule on a fine grid.

const SKY: f64 = 0.75;
const EDGE_FILM: u32 = 6;
const EDGE_FOV_DEG: f64 = 20.0;

/// The half-plane's edge runs through `EDGE_AT` along `EDGE_ALONG`; the plane is z = 0 and the
/// camera above.
const EDGE_AT: DVec3 = dvec3(0.04, 0.0, 0.0);
const EDGE_ALONG: DVec3 = dvec3(0.35, 1.0, 0.0);
const EYE: DVec3 = dvec3(0.0, 0.0, 3.0);

fn half_plane(filter: Filter) -> Scene {
    let along = EDGE_ALONG.as_vec3();
    let side = vec3(-4.0, 1.0, 0.0);
    let corner = EDGE_AT.as_vec3() - 5.0 * along;
    scene(
        EYE.as_vec3(),
        Vec3::ZERO,
        EDGE_FOV_DEG as f32,
        [EDGE_FILM; 2],
        filter,
    )
    .constant_environment([SKY as f32; 3])
    .solid(
        "blocker",
        parallelogram(corner, 10.0 * along, 2.0 * side),
        [0.0; 3],
    )
}

/// The film's u where the edge, moved by a motion of space, meets the row v: a point p is seen at
/// u = W/2·(1 − (p−o)·x/((p−o)·z·tan(fov/2))), and the same for v and y.
fn edge_at(scene: &Scene, v: f64, motion: impl Fn(DVec3) -> DVec3) -> f64 {
    let camera = scene.sensors[0].to_world;
    let axes = [camera.x_axis, camera.y_axis, camera.z_axis].map(|a| Vec3::from(a).as_dvec3());
    let tan = (EDGE_FOV_DEG.to_radians() / 2.0).tan();
    let film = |p: DVec3| {
        let p = p - EYE;
        let [x, y, z] = axes.map(|a| p.dot(a));
        [x, y].map(|c| f64::from(EDGE_FILM) / 2.0 * (1.0 - c / (z * tan)))
    };
    let [a, b] = [-2.0, 2.0].map(|t| film(motion(EDGE_AT + t * EDGE_ALONG)));
    a[0] + (b[0] - a[0]) * (v - a[1]) / (b[1] - a[1])
}

/// h_j(u)·(unnormalised) and its integral, along one axis.
fn filter_weight(filter: Filter, x: f64) -> f64 {
    let (weight, integral) = match filter {
        Filter::Box { .. } => (f64::from(u8::from(x.abs() < 0.5)), 1.0),
        Filter::Tent { .. } => ((1.0 - x.abs()).max(0.0), 1.0),
        Filter::Gaussian { stddev } => {
            let s = f64::from(stddev);
            let cut = (-8.0f64).exp();
            // ∫ of exp(−x²/2s²) within 4s is s·√2π·erf(4/√2).
            let integral = s * (2.0 * PI).sqrt() * 0.999_936_657_516_334 - 8.0 * s * cut;
            (
                ((-0.5 * (x / s).powi(2)).exp() - cut) * f64::from(u8::from(x.abs() < 4.0 * s)),
                integral,
            )
        }
    };
    weight / integral
}

/// All pixels' derivatives as the half-plane moves.
fn truth(scene: &Scene, filter: Filter, motion: impl Fn(DVec3, f64) -> DVec3) -> Vec<f64> {
    let steps = 4000;
    let size = EDGE_FILM as usize;
    let mut truth = vec![0.0; size * size];
    for k in 0..3 * steps {
        // The filters reach two pixels beyond the film.
        let v =
            -f64::from(EDGE_FILM) + (f64::from(k) + 0.5) * f64::from(EDGE_FILM) / f64::from(steps);
        let speed = derivative(|t| edge_at(scene, v, |p| motion(p, t)));
        let at = edge_at(scene, v, |p| p);
        for (j, value) in truth.iter_mut().enumerate() {
            let [x, y] = [j % size, j / size].map(|i| i as f64 + 0.5);
            let weight = filter_weight(filter, at - x) * filter_weight(filter, v - y);
            *value -= SKY * weight * speed * f64::from(EDGE_FILM) / f64::from(steps);
        }
    }
    truth
}

fn check_half_plane(
    filter: Filter,
    key: &str,
    values: &[f32],
    motion: impl Fn(DVec3, f64) -> DVec3,
) {
    let scene = half_plane(filter);
    let all = runs(&scene, key, values, 64);
    let truth = truth(&scene, filter, motion);
    let largest = truth.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    assert!(largest > 0.0);
    let estimates: Vec<Estimate> = (0..truth.len())
        .map(|j| Estimate::mean(&all.iter().map(|run| run[j]).collect::<Vec<_>>()))
        .collect();
    // What varies in a pixel is how many lattice lines the edge crosses there: an error may be zero
    // by luck, so that it counts as no less than half of the typical one. The quadrature knows the
    // ends of a box to one step.
    let on_edge = estimates.iter().zip(&truth).filter(|(_, t)| **t != 0.0);
    let (sum, count) = on_edge.fold((0.0, 0.0), |(s, n), (e, _)| {
        (s + e.error * e.error, n + 1.0)
    });
    let least = (0.5 * (sum / count).sqrt()).max(5e-4 * largest);
    let mut said_much = 0;
    for (j, (estimate, &truth)) in estimates.iter().zip(&truth).enumerate() {
        let error = estimate.error.max(least);
        assert!(
            (estimate.value - truth).abs() <= SIGMAS * error,
            "{key}, pixel {j}: {estimate:?}, truth {truth}"
        );
        said_much += usize::from(error <= RESOLUTION * truth.abs());
    }
    assert!(
        said_much >= EDGE_FILM as usize,
        "only {said_much} pixels say anything about {key}"
    );
}

#[test]
fn half_plane_translated() {
    for filter in [BOX, TENT, GAUSSIAN] {
        check_half_plane(filter, "blocker.translation", &[1.0, 0.0, 0.0], |p, t| {
            p + dvec3(t, 0.0, 0.0)
        });
    }
    check_half_plane(BOX, "blocker.translation", &[0.2, 0.4, 1.0], |p, t| {
        p + t * dvec3(0.2, 0.4, 1.0)
    });
}

/// Pieces of a straight edge cover it once before a box, so that no run has noise; with points in
/// their place a pixel would be off by some percent.
#[test]
fn a_straight_edge_before_a_box_has_no_noise() {
    let scene = half_plane(BOX);
    let truth = truth(&scene, BOX, |p, t| p + dvec3(t, 0.0, 0.0));
    let largest = truth.iter().fold(0.0f64, |m, t| m.max(t.abs()));
    let along = direction(&scene, &[("blocker.translation", &[1.0, 0.0, 0.0])]);
    let size = EDGE_FILM as usize;
    for seed in 1..=8 {
        let run = gradient(&scene, &settings(&scene, Method::Reparam, 64, seed), &along);
        // Within the film; at its border the last piece is where the lattice's shift has put it.
        for (j, (found, truth)) in run.iter().step_by(3).zip(&truth).enumerate() {
            if (1..size - 1).contains(&(j / size)) {
                let off = (found - truth).abs();
                assert!(off < 1e-3 * largest, "pixel {j}: {found}, truth {truth}");
            }
        }
    }
}

#[test]
fn half_plane_rotated_and_scaled() {
    // Turning a camera by +ω is turning the world by −ω about it.
    let turned = |p: DVec3, t: f64| EYE + glam::DQuat::from_rotation_z(-t) * (p - EYE);
    check_half_plane(GAUSSIAN, "cam.rotation", &[0.0, 0.0, 1.0], turned);
    check_half_plane(BOX, "cam.translation", &[1.0, 0.0, 1.0], |p, t| {
        p - t * dvec3(1.0, 0.0, 1.0)
    });
    // The pivot of a mesh is its bounding box' centre.
    let positions = half_plane(TENT).meshes.remove(0).positions;
    let low = positions
        .iter()
        .copied()
        .reduce(Vec3::min)
        .expect("corners")
        .as_dvec3();
    let high = positions
        .iter()
        .copied()
        .reduce(Vec3::max)
        .expect("corners")
        .as_dvec3();
    let pivot = (low + high) / 2.0;
    check_half_plane(TENT, "blocker.scale", &[1.0], |p, t| {
        pivot + (1.0 + t) * (p - pivot)
    });
    let turned = |p: DVec3, t: f64| pivot + glam::DQuat::from_rotation_z(t) * (p - pivot);
    check_half_plane(TENT, "blocker.rotation", &[0.0, 0.0, 1.0], turned);
}

// Things thinner than the distance of samples: a wire, and a slit between two plates, a fiftieth of
// a pixel wide.
//
// With a box filter the sum over all pixels is L times the area of free film, whose derivative is
// the edge's speed along u times the film's height.

const THIN: f32 = 0.004;

/// A parallelogram across the whole film, from its own edge on by `width` to the right.
fn strip(width: f32) -> common::shapes::Shape {
    let along = EDGE_ALONG.as_vec3();
    let corner = EDGE_AT.as_vec3() - 5.0 * along;
    parallelogram(corner, Vec3::X * width, 10.0 * along)
}

/// The derivative of the image's sum is that of the free area, whose edges move by `speed` along x
/// in all.
fn check_thin(scene: Scene, key: &str, values: &[f32], speed: f64) {
    let along = direction(&scene, &[(key, values)]);
    let sums: Vec<f64> = (1..=1500)
        .map(|seed| {
            let gradient = gradient(&scene, &settings(&scene, Method::Reparam, 64, seed), &along);
            gradient.iter().step_by(3).sum()
        })
        .collect();
    let size = f64::from(EDGE_FILM);
    let pixels_per_unit = size / (2.0 * (EDGE_FOV_DEG.to_radians() / 2.0).tan() * EYE.z);
    let truth = SKY * speed * pixels_per_unit * size;
    let sum = Estimate::mean(&sums);
    println!("{key}: {sum:?}, truth {truth}");
    assert!(
        sum.error <= RESOLUTION * truth.abs(),
        "{sum:?} says nothing"
    );
    assert!(
        sum.z(truth).abs() <= SIGMAS,
        "{key}: {sum:?}, truth {truth}"
    );
}

fn before_the_sky() -> Scene {
    scene(
        EYE.as_vec3(),
        Vec3::ZERO,
        EDGE_FOV_DEG as f32,
        [EDGE_FILM; 2],
        BOX,
    )
    .constant_environment([SKY as f32; 3])
}

#[test]
fn wire_that_grows() {
    let scene = before_the_sky().solid("wire", strip(THIN), [0.0; 3]);
    check_thin(scene, "wire.scale", &[1.0], -f64::from(THIN));
}

#[test]
fn slit_that_opens() {
    let right = strip(2.0)
        .0
        .into_iter()
        .map(|p| p + Vec3::X * THIN)
        .collect();
    let scene = before_the_sky().solid("left", strip(-2.0), [0.0; 3]).solid(
        "right",
        (right, strip(2.0).1),
        [0.0; 3],
    );
    check_thin(scene, "right.translation", &[1.0, 0.0, 0.0], 1.0);
}
