//! The shadow of a small disc under a large light, against its closed form: both edges of the
//! shadow lie between the same two points of many lines, and they move in opposite directions.
//!
//! The camera looks at one point x of a diffuse floor through a film so narrow that the radiance is
//! linear across it; its mean is ρL/π · E, with E = ∫cosθ dω over the visible part of a light of
//! radiance L. For a polygon with vertices v_i seen from x that integral is Lambert's: E = ½ Σ γ_i
//! n·m_i, with γ_i the angle between v_i and v_{i+1} and m_i the unit normal of the plane through
//! both and x. What a blocker hides of a light in a plane is a polygon too. The derivative of E is
//! taken by central differences in f64, whose error of 1e-9 is nothing beside the gradient's
//! standard error.

use common::scenes::*;
use common::statistics::Estimate;
use common::{direction, gradient, settings};
use glam::{DVec3, Vec3, dvec3, vec3};
use warpath::methods::Method;
use warpath::scene::Scene;

const RHO: f32 = 0.6;
const LIGHT: f32 = 3.0;
const RUNS: u64 = 12;

/// ∫cosθ dω over a polygon seen from the origin under the normal +z, counter-clockwise as seen from
/// there.
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

/// A floor around the origin, seen from the side, whose triangles are wound to be seen from above
/// or from below.
fn floor_point(from_above: bool) -> Scene {
    let (positions, mut triangles) = floor(20.0, 0.0);
    if !from_above {
        triangles.iter_mut().for_each(|t| t.reverse());
    }
    scene(vec3(-3.0, -0.3, 0.6), Vec3::ZERO, 0.05, [4, 4], BOX).solid(
        "floor",
        (positions, triangles),
        [RHO; 3],
    )
}

/// Holds the gradient along `parts` to ρL/π · `slope`, within four standard errors of at most 2 %;
/// and sees `interior` fail.
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

fn circle(corners: u32, radius: f64, z: f64) -> Vec<DVec3> {
    let corner = |k: u32| {
        let angle = -(k as f64) / corners as f64 * std::f64::consts::TAU;
        dvec3(radius * angle.cos(), radius * angle.sin(), z)
    };
    (0..corners).map(corner).collect()
}

const CORNERS: u32 = 24;

fn blocker() -> (Vec<Vec3>, Vec<[u32; 3]>) {
    disc(vec3(0.0, 0.0, 1.0), Vec3::NEG_Z, 0.2, CORNERS)
}

/// A disc that hides the middle of a larger square light.
#[test]
fn disc_blocker() {
    let hidden = |d: f64| -lambert(&circle(CORNERS, 0.4 * (1.0 + d), 2.0));
    for from_above in [true, false] {
        let scene = floor_point(from_above)
            .solid("blocker", blocker(), [0.0; 3])
            .light("lamp", ceiling(vec3(0.0, 0.0, 2.0), 0.8), [LIGHT; 3]);
        let along: [(&str, &[f32]); 1] = [("blocker.scale", &[1.0])];
        agrees(&scene, &along, 256, derivative(hidden), true);
    }
}

/// A disc before a sky.
#[test]
fn disc_before_the_sky() {
    let hidden = |d: f64| -lambert(&circle(CORNERS, 0.2 * (1.0 + d), 1.0));
    for from_above in [true, false] {
        let scene = floor_point(from_above)
            .solid("blocker", blocker(), [0.0; 3])
            .constant_environment([LIGHT; 3]);
        let along: [(&str, &[f32]); 1] = [("blocker.scale", &[1.0])];
        agrees(&scene, &along, 256, derivative(hidden), true);
    }
}
