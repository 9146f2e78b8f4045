//! Stated standard errors are the spread of repeated runs.
//!
//! Squares are compared, summed over all numbers of a result: E[s²] of the stated errors is the
//! variance that the runs show. The ratio's own sampling error comes from splitting the runs into
//! batches.

use common::comparison::thinned;
use common::scenes::*;
use common::statistics::Estimate;
use common::{Quiet, direction, flat, settings};
use glam::{Vec3, vec3};
use warpath::methods::{Image, Method, Objective, Settings, backward, forward};
use warpath::scene::Scene;
use warpath::scene::parameters::{self, Gradient, Parameter};

const BATCHES: u64 = 8;
/// The ratio of stated error and spread.
const TOLERANCE: f64 = 0.1;

fn tiny(filter: warpath::scene::Filter) -> Scene {
    let block = placed(
        cuboid(vec3(0.4, 0.3, 0.2)),
        vec3(12.0, 25.0, 33.0),
        vec3(0.1, 0.0, 0.6),
    );
    scene(vec3(0.3, -3.4, 1.9), Vec3::ZERO, 30.0, [8, 6], filter)
        .depth(3)
        .constant_environment([0.2, 0.3, 0.4])
        .solid("floor", floor(2.0, 0.0), [0.6, 0.5, 0.4])
        .solid("block", block, [0.3, 0.6, 0.5])
        .light("lamp", ceiling(vec3(0.2, 0.1, 2.2), 0.5), [8.0, 7.0, 6.0])
}

/// Many numbers and the standard error stated of each.
type Stated = (Vec<f64>, Vec<f64>);

/// The ratio of the stated errors to the spread, in root mean square.
fn ratio(runs_per_batch: u64, run: impl Fn(u64) -> Stated) -> Estimate {
    let batch = |batch: u64| {
        let seeds = batch * runs_per_batch..(batch + 1) * runs_per_batch;
        let runs: Vec<Stated> = seeds.map(|seed| run(seed + 1)).collect();
        let count = runs.len() as f64;
        let variance = |i: usize| {
            let mean = runs.iter().map(|r| r.0[i]).sum::<f64>() / count;
            runs.iter().map(|r| (r.0[i] - mean).powi(2)).sum::<f64>() / (count - 1.0)
        };
        let spread: f64 = (0..runs[0].0.len()).map(variance).sum();
        let stated = runs.iter().flat_map(|r| &r.1).map(|e| e * e).sum::<f64>() / count;
        (stated, spread)
    };
    let batches: Vec<(f64, f64)> = (0..BATCHES).map(batch).collect();
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| batches.iter().map(of).sum::<f64>();
    // Leaving one batch out at a time (a jackknife): a ratio's error without assumptions.
    let all = (sum(&|b| b.0) / sum(&|b| b.1)).sqrt();
    let without: Vec<f64> = (batches.iter())
        .map(|b| ((sum(&|b| b.0) - b.0) / (sum(&|b| b.1) - b.1)).sqrt())
        .collect();
    let n = BATCHES as f64;
    let error = ((n - 1.0) / n * without.iter().map(|w| (w - all).powi(2)).sum::<f64>()).sqrt();
    Estimate { value: all, error }
}

fn check(what: &str, ratio: Estimate) {
    println!("{what}: {ratio:?}");
    assert!(
        3.0 * ratio.error <= TOLERANCE,
        "{what}: {ratio:?} says nothing"
    );
    assert!((ratio.value - 1.0).abs() <= TOLERANCE, "{what}: {ratio:?}");
}

fn stated(scene: &Scene, spp: u32, seed: u64) -> Settings {
    Settings {
        standard_error: true,
        ..settings(scene, Method::Reparam, spp, seed)
    }
}

#[test]
fn of_gradient_images() {
    for (name, filter) in [("box", BOX), ("gaussian", GAUSSIAN)] {
        let scene = tiny(filter);
        let along = direction(&scene, &[("block.translation", &[1.0, 0.3, 0.2])]);
        for spp in [4, 16, 64] {
            let run = |seed| {
                let result = forward(&scene, &stated(&scene, spp, seed), &along, &Quiet)
                    .expect("a gradient image");
                (
                    flat(&result.gradient),
                    flat(&result.stderr.expect("standard errors")),
                )
            };
            check(
                &format!("forward, {name} filter, {spp} samples"),
                ratio(16, run),
            );
        }
    }
}

#[test]
fn of_finite_differences() {
    let scene = tiny(GAUSSIAN);
    let along = direction(&scene, &[("block.translation", &[1.0, 0.3, 0.2])]);
    let run = |seed| {
        let settings = Settings {
            method: Method::Fd,
            ..stated(&scene, 16, seed)
        };
        let result = forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
        (
            flat(&result.gradient),
            flat(&result.stderr.expect("standard errors")),
        )
    };
    check("differences", ratio(16, run));
}

/// The mean of a gradient's groups and its standard error, number by number.
fn of_groups(scene: &Scene, wanted: &Parameter, spp: u32, seed: u64) -> Stated {
    let weight = Image {
        width: 8,
        height: 6,
        pixels: vec![[0.3, 0.2, 0.4]; 48],
    };
    let objective = Objective::Adjoint(&weight);
    let settings = stated(scene, spp, seed);
    let result = backward(
        scene,
        &settings,
        std::slice::from_ref(wanted),
        &objective,
        &Quiet,
    )
    .expect("a gradient");
    let reduced = |gradient: &Gradient| -> Vec<f64> {
        let numbers = gradient.by(scene, wanted).into_iter();
        numbers.map(f64::from).collect()
    };
    let groups: Vec<Vec<f64>> = result.groups.iter().map(reduced).collect();
    let number = |i: usize| Estimate::mean(&groups.iter().map(|g| g[i]).collect::<Vec<_>>());
    let numbers: Vec<Estimate> = (0..groups[0].len()).map(number).collect();
    let mean = reduced(&result.gradient);
    for (mean, number) in mean.iter().zip(&numbers) {
        assert!(
            (mean - number.value).abs() <= 1e-5 * number.value.abs().max(number.error),
            "no mean of its groups"
        );
    }
    (mean, numbers.into_iter().map(|e| e.error).collect())
}

#[test]
fn of_gradients() {
    let scene = tiny(GAUSSIAN);
    // A handful of numbers says less about their spread than many do.
    let cases = [
        ("block.vertex_positions", 4, 48),
        ("block.vertex_positions", 16, 24),
        ("block.vertex_positions", 64, 24),
        ("cam.rotation", 16, 160),
        ("floor.bsdf.reflectance.value", 16, 160),
    ];
    for (key, samples, runs) in thinned(2, cases) {
        let wanted = parameters::find(&scene, key).expect("a key");
        let run = |seed| of_groups(&scene, &wanted, samples, seed);
        check(&format!("{key}, {samples} samples"), ratio(runs, run));
    }
}
