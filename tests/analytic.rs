//! Gradients against closed forms.
//!
//! The camera looks at one point x of a diffuse floor through a film so narrow that the radiance is linear across it; its mean is
//! ρL/π · E, with E = ∫cosθ dω over the visible part of a light of radiance L. For a polygon with vertices v_i seen
//! from x that integral is Lambert's: E = ½ Σ γ_i n·m_i, with γ_i the angle between v_i and v_{i+1} and m_i the unit normal of
//! the plane through both and x. What a blocker hides of a light in a plane is a polygon too. The derivative of E is
//! taken by central differences in f64, whose error of 1e-9 is nothing beside the gradient's standard error.

mod common;

use common::scenes::*;
use common::shapes::{Shape, icosphere};
use common::statistics::Estimate;
use common::{direction, gradient, settings};
use glam::{DVec3, Vec3, dvec3, vec3};
use warpath::methods::Method;
use warpath::scene::Scene;

const RHO: f32 = 0.6;
const LIGHT: f32 = 3.0;
const RUNS: u64 = 12;

/// ∫cosθ dω over a polygon seen from the origin under the normal +z, counter-clockwise as seen from there.
fn lambert(polygon: &[DVec3]) -> f64 {
    let edge = |(i, a): (usize, &DVec3)| {
        let b = polygon[(i + 1) % polygon.len()];
        a.angle_between(b) * b.cross(*a).normalize().z / 2.0
    };
    polygon.iter().enumerate().map(edge).sum()
}

fn derivative(f: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-4;
    (f(h) - f(-h)) / (2.0 * h)
}

/// A floor around the origin, seen from the side.
fn floor_point() -> Scene {
    scene(vec3(-3.0, -0.3, 0.6), Vec3::ZERO, 0.05, [4, 4], BOX).solid(
        "floor",
        floor(20.0, 0.0),
        [RHO; 3],
    )
}

/// Holds the gradient along `parts` to ρL/π · `slope`, within four standard errors of at most 2 %; and sees `interior` fail.
fn agrees(scene: &Scene, parts: &[(&str, &[f32])], spp: u32, slope: f64, visibility: bool) {
    let truth = (RHO * LIGHT) as f64 / std::f64::consts::PI * slope;
    let mean = |method: Method| {
        let along = direction(scene, parts);
        let run = |seed| {
            let image = gradient(scene, &settings(scene, method, spp, seed), &along);
            image.iter().sum::<f64>() / image.len() as f64
        };
        Estimate::mean(&(1..=RUNS).map(run).collect::<Vec<f64>>())
    };
    let ours = mean(Method::Reparam);
    println!("truth {truth:.6}: {:.6} ± {:.6}", ours.value, ours.error);
    assert!(
        ours.error <= 0.02 * truth.abs(),
        "nothing can be said: ± {}",
        ours.error
    );
    assert!(
        ours.z(truth).abs() <= 4.0,
        "{} ± {} is not {truth}",
        ours.value,
        ours.error
    );
    if visibility {
        let naive = mean(Method::Interior);
        assert!(
            naive.z(truth).abs() > 4.0,
            "interior: {} ± {}",
            naive.value,
            naive.error
        );
    }
}

/// The polygon of corners (x, y) in the plane at height z, counter-clockwise from below.
fn rectangle(x: [f64; 2], y: [f64; 2], z: f64) -> Vec<DVec3> {
    vec![
        dvec3(x[0], y[0], z),
        dvec3(x[0], y[1], z),
        dvec3(x[1], y[1], z),
        dvec3(x[1], y[0], z),
    ]
}

/// A square light at height 2, half hidden by everything beyond x = a at height 1: its shadow edge on the light is at 2a.
#[test]
fn half_plane_blocker() {
    let a = 0.1;
    let blocker = parallelogram(
        vec3(a, -9.0, 1.0),
        vec3(9.0, 0.0, 0.0),
        vec3(0.0, 18.0, 0.0),
    );
    let scene = floor_point().solid("blocker", blocker, [0.0; 3]).light(
        "lamp",
        ceiling(vec3(0.0, 0.0, 2.0), 0.5),
        [LIGHT; 3],
    );
    let seen = |d: f64| lambert(&rectangle([-0.5, 2.0 * (a as f64 + d)], [-0.5, 0.5], 2.0));
    agrees(
        &scene,
        &[("blocker.translation", &[1.0, 0.0, 0.0])],
        64,
        derivative(seen),
        true,
    );
    // Lowering the blocker moves its shadow too: the edge is at 2a/z.
    let lowered = |d: f64| {
        lambert(&rectangle(
            [-0.5, 2.0 * a as f64 / (1.0 + d)],
            [-0.5, 0.5],
            2.0,
        ))
    };
    agrees(
        &scene,
        &[("blocker.translation", &[0.0, 0.0, 1.0])],
        64,
        derivative(lowered),
        true,
    );
}

fn circle(corners: u32, radius: f64, z: f64) -> Vec<DVec3> {
    let corner = |k: u32| {
        let angle = -(k as f64) / corners as f64 * std::f64::consts::TAU;
        dvec3(radius * angle.cos(), radius * angle.sin(), z)
    };
    (0..corners).map(corner).collect()
}

/// A disc light straight above: E = π r²/(r² + h²) for a circle, a little less for the polygon.
#[test]
fn disc_light() {
    const CORNERS: u32 = 24;
    let (r, h) = (0.8, 1.5);
    let area = |r: f64, h: f64| lambert(&circle(CORNERS, r, h));
    let exact = std::f64::consts::PI * r * r / (r * r + h * h);
    assert!(
        (area(r, h) / exact - 1.0).abs() < 0.02,
        "Lambert's formula is misused"
    );
    let disc = disc(vec3(0.0, 0.0, h as f32), Vec3::NEG_Z, r as f32, CORNERS);
    let scene = floor_point().light("lamp", disc, [LIGHT; 3]);
    agrees(
        &scene,
        &[("lamp.scale", &[1.0])],
        64,
        derivative(|d| area(r * (1.0 + d), h)),
        false,
    );
    agrees(
        &scene,
        &[("lamp.translation", &[0.0, 0.0, 1.0])],
        64,
        derivative(|d| area(r, h + d)),
        false,
    );
}

/// A disc that hides the middle of a larger square light.
#[test]
fn disc_blocker() {
    const CORNERS: u32 = 24;
    let blocker = disc(vec3(0.0, 0.0, 1.0), Vec3::NEG_Z, 0.2, CORNERS);
    let scene = floor_point().solid("blocker", blocker, [0.0; 3]).light(
        "lamp",
        ceiling(vec3(0.0, 0.0, 2.0), 0.8),
        [LIGHT; 3],
    );
    let hidden = |d: f64| -lambert(&circle(CORNERS, 0.4 * (1.0 + d), 2.0));
    agrees(
        &scene,
        &[("blocker.scale", &[1.0])],
        256,
        derivative(hidden),
        true,
    );
}

/// A tessellated sphere light: the sum of Lambert's formula over the triangles that look at the floor. For a round one
/// E = π (r/d)² cosθ.
#[test]
fn sphere_light() {
    let (centre, radius) = (vec3(0.4, 0.2, 2.0), 0.5);
    let shape: Shape = icosphere(2, centre, radius);
    let (positions, triangles) = shape.clone();
    let irradiance = |scale: f64, shift: DVec3| -> f64 {
        let at = |v: u32| {
            let p = positions[v as usize].as_dvec3();
            centre.as_dvec3() + (p - centre.as_dvec3()) * scale + shift
        };
        let facing = |t: &[u32; 3]| lambert(&t.map(at)).max(0.0);
        triangles.iter().map(facing).sum()
    };
    let distance2 = centre.as_dvec3().length_squared();
    let round = std::f64::consts::PI * 0.25 / distance2 * centre.z as f64 / distance2.sqrt();
    assert!(
        (irradiance(1.0, DVec3::ZERO) / round - 1.0).abs() < 0.05,
        "Lambert's formula is misused"
    );
    let scene = floor_point().light("lamp", shape, [LIGHT; 3]);
    agrees(
        &scene,
        &[("lamp.scale", &[1.0])],
        256,
        derivative(|d| irradiance(1.0 + d, DVec3::ZERO)),
        false,
    );
    let moved = |d: f64| irradiance(1.0, dvec3(0.0, 0.0, d));
    agrees(
        &scene,
        &[("lamp.translation", &[0.0, 0.0, 1.0])],
        256,
        derivative(moved),
        false,
    );
}
