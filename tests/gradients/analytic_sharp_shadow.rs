//! The straight shadow that a half-plane throws on a floor, against its closed form.
//!
//! The camera looks straight down, and the half-plane is above it: x ≤ e at height h. A point light
//! at l shadows the floor up to x_s = l_x + (e − l_x) l_z / (l_z − h), a directional one, which
//! travels along w, up to x_s = e − h w_x / w_z. The film is linear on the floor, so that the mean of the
//! image is that of the radiance over the square of half side X that is seen,
//!
//! ∫_{x_s}^X ∫_{−X}^X L dy dx / (2X)²,   L = ρ/π · I l_z / r³   or   L = ρ/π · E |w_z|.
//!
//! The inner integral is closed: ∫ r⁻³ dy = y / (a² r) with a² = r² − y². The outer one is taken by
//! Simpson's rule and the derivative by central differences, both in f64, with errors of 1e-9.

use common::scenes::*;
use common::statistics::Estimate;
use common::{direction, gradient, settings};
use glam::{DVec3, Vec3, dvec3, vec3};
use warpath::methods::Method;
use warpath::scene::{DeltaLightKind, Scene};

const RHO: f64 = 0.6;
const HEIGHT: f64 = 1.5;
const END: f64 = 0.05;
const INTENSITY: f64 = 5.0;
const LIGHT: DVec3 = dvec3(0.3, -0.2, 3.0);
const ALONG: DVec3 = dvec3(0.1, 0.05, -0.9);
const X_FOV_DEG: f64 = 60.0;
const RUNS: u64 = 12;

/// Half the side of the square that is seen.
fn half_side() -> f64 {
    (X_FOV_DEG / 2.0).to_radians().tan()
}

fn view(light: DeltaLightKind) -> Scene {
    let eye = vec3(0.0, 0.0, 1.0);
    let far = 50.0;
    let half_plane = parallelogram(
        vec3(END as f32, -far, HEIGHT as f32),
        vec3(0.0, 2.0 * far, 0.0),
        vec3(-far, 0.0, 0.0),
    );
    scene(eye, Vec3::ZERO, X_FOV_DEG as f32, [12; 2], BOX)
        .solid("floor", floor(2.0, 0.0), [RHO as f32; 3])
        .solid("plane", half_plane, [0.0; 3])
        .delta_light("light", light, [INTENSITY as f32; 3])
}

fn simpson(f: impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> f64 {
    const PARTS: usize = 400;
    let h = (to - from) / PARTS as f64;
    let term = |i: usize| {
        let weight = [4.0, 2.0][(i + 1) % 2];
        let weight = if i == 0 || i == PARTS { 1.0 } else { weight };
        weight * f(from + i as f64 * h)
    };
    (0..=PARTS).map(term).sum::<f64>() * h / 3.0
}

fn by_point(end: f64, height: f64, light: DVec3) -> f64 {
    let shadow = light.x + (end - light.x) * light.z / (light.z - height);
    let x_max = half_side();
    let over_y = |x: f64| {
        let a2 = (x - light.x).powi(2) + light.z * light.z;
        let up_to = |y: f64| (y - light.y) / (a2 * (a2 + (y - light.y).powi(2)).sqrt());
        up_to(x_max) - up_to(-x_max)
    };
    let all = simpson(over_y, [shadow, x_max]);
    RHO / std::f64::consts::PI * INTENSITY * light.z * all / (2.0 * x_max).powi(2)
}

fn by_direction(end: f64, height: f64, along: DVec3) -> f64 {
    let along = along.normalize();
    let shadow = end - height * along.x / along.z;
    let x_max = half_side();
    let seen = (x_max - shadow) / (2.0 * x_max);
    RHO / std::f64::consts::PI * INTENSITY * along.z.abs() * seen
}

fn derivative(f: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-4;
    (f(h) - f(-h)) / (2.0 * h)
}

fn agrees(scene: &Scene, parts: &[(&str, &[f32])], slope: f64) {
    let mean = |method: Method| {
        let along = direction(scene, parts);
        let run = |seed| {
            let image = gradient(scene, &settings(scene, method, 64, seed), &along);
            image.iter().sum::<f64>() / image.len() as f64
        };
        Estimate::mean(&(1..=RUNS).map(run).collect::<Vec<f64>>())
    };
    let [ours, naive] = [Method::Reparam, Method::Interior].map(mean);
    println!(
        "{parts:?} {slope:.7}: {:.7} ± {:.7}",
        ours.value, ours.error
    );
    assert!(
        ours.error <= 0.001 * slope.abs(),
        "nothing can be said: ± {}",
        ours.error
    );
    assert!(
        // Under an even light each cell brings the same, and only rounding is left.
        (ours.value - slope).abs() <= 4.0 * ours.error + 1e-6 * slope.abs(),
        "{} ± {} is not {slope}",
        ours.value,
        ours.error
    );
    assert!(
        (naive.value - slope).abs() > 0.05 * slope.abs(),
        "interior: {} ± {}",
        naive.value,
        naive.error
    );
}

#[test]
fn of_a_point_light() {
    let scene = view(DeltaLightKind::Point {
        position: LIGHT.as_vec3(),
    });
    let moved = |t| by_point(END + t, HEIGHT, LIGHT);
    agrees(
        &scene,
        &[("plane.translation", &[1.0, 0.0, 0.0])],
        derivative(moved),
    );
    let raised = |t| by_point(END, HEIGHT + t, LIGHT);
    agrees(
        &scene,
        &[("plane.translation", &[0.0, 0.0, 1.0])],
        derivative(raised),
    );
    let along = dvec3(1.0, 0.4, -0.7);
    let lit = |t: f64| by_point(END, HEIGHT, LIGHT + t * along);
    agrees(
        &scene,
        &[("light.position", &[1.0, 0.4, -0.7])],
        derivative(lit),
    );
}

#[test]
fn of_a_directional_light() {
    let scene = view(DeltaLightKind::Directional {
        direction: ALONG.normalize().as_vec3(),
    });
    let moved = |t| by_direction(END + t, HEIGHT, ALONG);
    agrees(
        &scene,
        &[("plane.translation", &[1.0, 0.0, 0.0])],
        derivative(moved),
    );
    let raised = |t| by_direction(END, HEIGHT + t, ALONG);
    agrees(
        &scene,
        &[("plane.translation", &[0.0, 0.0, 1.0])],
        derivative(raised),
    );
}
