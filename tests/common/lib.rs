//! What the tests of the whole engine share: scenes as plain data, runs, and statistics.

pub mod compared;
pub mod comparison;
pub mod fading;
pub mod materials;
pub mod optics;
pub mod picture_files;
pub mod scenes;
pub mod shapes;
pub mod statistics;
pub mod swatch;
pub mod transposition;

use warpath::methods::{self, Method, Objective, Progress, Settings};
use warpath::scene::Scene;
use warpath::scene::parameters::{self, Parameter};
use warpath::trace::Backend;

/// Says nothing and is never cancelled.
pub struct Quiet;

impl Progress for Quiet {
    fn advance(&self, _: u64, _: u64) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// What the scene says, with `spp` samples and random numbers of `seed`, on one thread, without
/// roulette.
pub fn settings(scene: &Scene, method: Method, spp: u32, seed: u64) -> Settings {
    Settings {
        spp,
        seed,
        threads: 1,
        max_depth: scene.integrator.max_depth,
        rr_depth: u32::MAX,
        hide_emitters: scene.integrator.hide_emitters,
        sensor: 0,
        resolution: None,
        method,
        backend: Backend::default(),
        standard_error: false,
        groups: None,
        constants: Default::default(),
        part_of_film: None,
        counts_tiles: false,
        noise: None,
    }
}

/// A direction in parameter space, as the engine takes it.
pub type Direction = Vec<(Parameter, Vec<f32>)>;

/// The direction of some parameters' keys, each with its values or those of its last axis.
pub fn direction(scene: &Scene, parts: &[(&str, &[f32])]) -> Direction {
    let find = |key: &str| parameters::find(scene, key).expect("a key of the scene");
    let full = |p: &Parameter, v: &[f32]| v.repeat(p.len() / v.len());
    let pairs = parts.iter().map(|(key, values)| (find(key), *values));
    pairs.map(|(p, v)| (p.clone(), full(&p, v))).collect()
}

/// All numbers of an image in order, in double precision.
pub fn flat(image: &methods::Image) -> Vec<f64> {
    image
        .pixels
        .iter()
        .flatten()
        .map(|x| f64::from(*x))
        .collect()
}

/// The gradient image along a direction, by any method.
pub fn gradient(scene: &Scene, settings: &Settings, direction: &Direction) -> Vec<f64> {
    flat(
        &methods::forward(scene, settings, direction, &Quiet)
            .expect("a gradient image")
            .gradient,
    )
}

/// Gradient images with these seeds.
pub fn runs(
    scene: &Scene,
    (method, spp): (Method, u32),
    direction: &Direction,
    seeds: std::ops::Range<u64>,
) -> Vec<Vec<f64>> {
    let of = |seed| gradient(scene, &settings(scene, method, spp, seed), direction);
    seeds.map(of).collect()
}

/// Fails if a thousandth of all cells whose ends differ have no silhouette that was found.
pub fn loses_nothing(scene: &Scene, settings: &Settings, direction: &Direction) {
    let statistics = methods::forward(scene, settings, direction, &Quiet)
        .expect("a gradient image")
        .statistics;
    let lost = statistics.rejected.get("silhouette_not_found").copied();
    let (lost, found) = (lost.unwrap_or(0), statistics.borders.all().found);
    println!("{lost} of {}", found + lost);
    assert!(lost * 1000 < found, "{lost} of {found}");
}

/// The variance between the gradients of runs with these seeds, summed over all numbers.
pub fn variance(
    scene: &Scene,
    (method, spp): (Method, u32),
    direction: &Direction,
    seeds: std::ops::Range<u64>,
) -> f64 {
    let count = (seeds.end - seeds.start) as f64;
    let runs = runs(scene, (method, spp), direction, seeds);
    let of_number = |i: usize| {
        let mean = runs.iter().map(|r| r[i]).sum::<f64>() / count;
        runs.iter().map(|r| (r[i] - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    (0..runs[0].len()).map(of_number).sum()
}

/// By how much one scene's gradient is noisier than another's, for each of these seeds.
pub fn noise_ratios<const N: usize>(
    [noisy, quiet]: [&Scene; 2],
    parts: &[(&str, &[f32])],
    seeds: [std::ops::Range<u64>; N],
) -> [f64; N] {
    let noise = |scene: &Scene, seeds| {
        let along = direction(scene, parts);
        variance(scene, (Method::Reparam, 64), &along, seeds)
    };
    seeds.map(|seeds| noise(noisy, seeds.clone()) / noise(quiet, seeds))
}

/// The gradient image by central differences of two sizes with common random numbers, its error in
/// step² removed. `step` is along the direction.
pub fn differences(
    scene: &Scene,
    settings: &Settings,
    direction: &Direction,
    step: f64,
) -> Vec<f64> {
    let at = |offset: f64| {
        let moved = parameters::displace(scene, direction, offset).expect("a scene nearby");
        flat(
            &methods::render(&moved, settings, &Quiet)
                .expect("an image")
                .image,
        )
    };
    let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| at(k * step));
    let value = |i: usize| (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * step);
    (0..a.len()).map(value).collect()
}

/// The gradients of some parameters of ⟨image, weight⟩, each of its parameter's length.
pub fn pull_back(
    scene: &Scene,
    settings: &Settings,
    wanted: &[Parameter],
    weight: &methods::Image,
) -> Vec<Vec<f32>> {
    let objective = Objective::Adjoint(weight);
    let result =
        methods::backward(scene, settings, wanted, &objective, &Quiet).expect("a gradient");
    wanted
        .iter()
        .map(|p| result.gradient.by(scene, p))
        .collect()
}

pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
