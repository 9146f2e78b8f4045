//! Surfaces that are black reflect nothing, and have a gradient by how much they would.

use common::comparison::{SKY, close_up};
use common::materials::Paint;
use common::scenes::*;
use common::{Quiet, direction, flat, gradient, settings};
use glam::vec3;
use warpath::methods::{self, Method, Settings};
use warpath::scene::{DeltaLight, DeltaLightKind, Scene, Texture};

const KEYS: [&str; 2] = [
    "floor.bsdf.brdf_0.reflectance.value",
    "block.bsdf.brdf_0.reflectance.value",
];

/// Both surfaces of this reflectance.
fn painted(mut scene: Scene, reflectance: f32) -> Scene {
    for texture in &mut scene.textures {
        if KEYS.contains(&format!("{}.value", texture.key).as_str()) {
            texture.texels = vec![[reflectance; 3]];
        }
    }
    scene
}

/// One scene for each kind of light, of paths with three segments.
fn lit() -> Vec<(&'static str, Scene)> {
    let scene = close_up().depth(3);
    let mut bulb = scene.clone();
    bulb.textures
        .push(Texture::constant("bulb.intensity".into(), [3.0; 3]));
    bulb.delta_lights.push(DeltaLight {
        key: "bulb".into(),
        kind: DeltaLightKind::Point {
            position: vec3(0.9, -0.6, 1.8),
        },
        power: bulb.textures.len() - 1,
        beam: None,
    });
    let lamp = ceiling(vec3(0.8, -0.5, 2.0), 0.4);
    vec![
        ("sky", scene.clone().constant_environment(SKY)),
        ("sunny", scene.clone().sunny()),
        ("lamp", scene.light("lamp", lamp, [4.0; 3])),
        ("bulb", bulb),
    ]
}

fn by_reflectance(scene: &Scene, settings: &Settings) -> Vec<f64> {
    let along = direction(scene, &KEYS.map(|key| (key, [1.0].as_slice())));
    gradient(scene, settings, &along)
}

/// A pixel is a polynomial of second degree in the reflectance, with one set of random numbers:
/// three points give its slope at zero to rounding.
#[test]
fn slopes_at_zero() {
    const STEP: f32 = 0.1;
    for (name, scene) in lit() {
        let settings = settings(&scene, Method::Reparam, 16, 3);
        let image = |reflectance: f32| {
            let scene = painted(scene.clone(), reflectance);
            flat(
                &methods::render(&scene, &settings, &Quiet)
                    .expect("an image")
                    .image,
            )
        };
        let [at_0, at_1, at_2] = [0.0, STEP, 2.0 * STEP].map(image);
        let black = painted(scene.clone(), 0.0);
        let got = by_reflectance(&black, &settings);
        let differences = Settings {
            method: Method::Fd,
            ..settings.clone()
        };
        let differences = by_reflectance(&black, &differences);
        let brightest = at_2.iter().copied().fold(0.0, f64::max);
        let rounding = 4.0 * 64.0 * f64::from(f32::EPSILON) * brightest / f64::from(STEP);
        let mut largest = 0.0f64;
        for i in 0..got.len() {
            let slope = (4.0 * at_1[i] - at_2[i] - 3.0 * at_0[i]) / (2.0 * f64::from(STEP));
            largest = largest.max(slope);
            let error = (got[i] - slope).abs();
            assert!(
                error <= rounding,
                "{name}, number {i}: {} for {slope}",
                got[i]
            );
            // Their step is a tenth of this one.
            let error = (differences[i] - slope).abs();
            assert!(
                error <= 10.0 * rounding,
                "{name}, number {i}: {} by differences for {slope}",
                differences[i]
            );
        }
        assert!(largest > 100.0 * rounding, "{name} is dark");
    }
}

/// Roulette takes black paths as far as others, only more rarely.
#[test]
fn roulette_does_not_end_at_black() {
    for (name, scene) in lit() {
        let scene = painted(scene.depth(4), 0.0);
        // The mean over the picture, run by run.
        let runs = |rr_depth: u32| -> Vec<f64> {
            (0..24)
                .map(|seed| {
                    let settings = Settings {
                        rr_depth,
                        ..settings(&scene, Method::Interior, 16, seed)
                    };
                    let all = by_reflectance(&scene, &settings);
                    all.iter().sum::<f64>() / all.len() as f64
                })
                .collect()
        };
        let [(a, a_error), (b, b_error)] = [runs(u32::MAX), runs(1)].map(|r| mean(&r));
        let error = a_error.hypot(b_error);
        assert!(
            (a - b).abs() <= 4.0 * error,
            "{name}: {a} ± {a_error} without, {b} ± {b_error} with roulette"
        );
        assert!(error < 0.05 * a, "{name}: {error} of {a} says nothing");
    }
}

/// With its standard error.
fn mean(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, (squares / (n * (n - 1.0))).sqrt())
}
