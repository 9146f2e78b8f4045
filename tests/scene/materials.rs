//! The same file renders to the same image as in Mitsuba 3: block means of every scene in
//! `scenes/materials` against those in `tests/scene/mitsuba`, with the standard errors of both.

use common::{Quiet, settings};
use std::path::Path;
use warpath::methods::{Method, Settings, render};
use warpath::scene::load;

/// Blocks along each side of the film.
const BLOCKS: usize = 4;
const SEEDS: u64 = 32;
const SPP: u32 = 64;
/// Of the worst of a scene's 48 numbers in standard errors, and of the mean of their squares (which
/// is 1 if all errors are right) in its own.
const WORST: f64 = 5.0;
/// Where every sample is the same, single precision is left.
const ROUNDING: f64 = 4e-5;

/// Mean and standard error of each block and channel, from Mitsuba.
fn reference(name: &str) -> Vec<[f64; 2]> {
    let path = Path::new("tests/scene/mitsuba").join(format!("{name}.txt"));
    let text = std::fs::read_to_string(path).expect("a reference");
    let mut blocks = Vec::new();
    for line in text.lines().filter(|l| !l.starts_with('#')) {
        let numbers: Vec<f64> = line
            .split_whitespace()
            .map(|w| w.parse().unwrap())
            .collect();
        assert_eq!(numbers.len(), 8, "{line}");
        blocks.extend((0..3).map(|c| [numbers[2 + c], numbers[5 + c]]));
    }
    assert_eq!(blocks.len(), 3 * BLOCKS * BLOCKS);
    blocks
}

fn block_means(image: &warpath::methods::Image) -> Vec<f64> {
    let size = image.width / BLOCKS;
    let mut sums = vec![0.0; 3 * BLOCKS * BLOCKS];
    for (i, pixel) in image.pixels.iter().enumerate() {
        let (row, column) = (i / image.width / size, i % image.width / size);
        for c in 0..3 {
            sums[3 * (row * BLOCKS + column) + c] += pixel[c] as f64 / (size * size) as f64;
        }
    }
    sums
}

fn agrees(name: &str) {
    let path = format!("scenes/materials/{name}.xml");
    let scene = load(&path, &[]).expect("a scene");
    let runs: Vec<Vec<f64>> = (0..SEEDS)
        .map(|seed| {
            let settings: Settings = settings(&scene, Method::Reparam, SPP, seed + 1);
            block_means(&render(&scene, &settings, &Quiet).expect("an image").image)
        })
        .collect();
    let n = SEEDS as f64;
    let mut squares = 0.0;
    // Of each run and number, its part in the error of the mean, in standard errors.
    let mut parts = vec![Vec::new(); runs.len()];
    let mut wrong = Vec::new();
    let references = reference(name);
    for (i, [mean, error]) in references.iter().enumerate() {
        let own = runs.iter().map(|r| r[i]).sum::<f64>() / n;
        let spread = runs.iter().map(|r| (r[i] - own).powi(2)).sum::<f64>() / (n - 1.0) / n;
        let rounding = ROUNDING * (mean.abs() + 1e-2);
        let sigma = (spread + error * error + rounding * rounding).sqrt();
        let z = (own - mean) / sigma;
        squares += z * z / references.len() as f64;
        for (part, run) in parts.iter_mut().zip(&runs) {
            part.push((run[i] - own) / n / sigma);
        }
        if z.abs() > WORST {
            let (block, channel) = (i / 3, i % 3);
            wrong.push(format!(
                "block {},{} channel {channel}: {own:.6} against {mean:.6}, ±{sigma:.1e}, z {z:.1}",
                block / BLOCKS,
                block % BLOCKS
            ));
        }
    }
    let error = error_of_mean_square(&parts);
    println!(
        "{name}: mean z² {squares:.2} ± {error:.2}, {} of {} beyond {WORST} σ",
        wrong.len(),
        references.len()
    );
    assert!(
        wrong.is_empty() && squares < 1.0 + WORST * error,
        "{name}: mean z² {squares:.2} ± {error:.2}\n{}",
        wrong.join("\n")
    );
}

/// The standard error of the mean of the squares of errors that are correlated, √(2 Σ ρᵢⱼ²)/count:
/// one shift of the film's lattice moves all blocks of a run.
fn error_of_mean_square(parts: &[Vec<f64>]) -> f64 {
    let (n, count) = (parts.len() as f64, parts[0].len());
    let mut sum = count as f64;
    for i in 0..count {
        for j in (0..count).filter(|&j| j != i) {
            let covariance = parts.iter().map(|p| p[i] * p[j]).sum::<f64>() * n / (n - 1.0);
            // What chance alone makes of so few runs.
            sum += (covariance.powi(2) - 1.0 / n).max(0.0);
        }
    }
    (2.0 * sum).sqrt() / count as f64
}

macro_rules! scenes {
    ($($name:ident)*) => {
        $(#[test]
        fn $name() {
            agrees(stringify!($name));
        })*

        #[test]
        fn none_is_left_out() {
            let names = [$(stringify!($name)),*];
            for entry in std::fs::read_dir("scenes/materials").expect("scenes") {
                let path = entry.expect("an entry").path();
                if path.extension().is_some_and(|e| e == "xml") {
                    let name = path.file_stem().expect("a name").to_string_lossy().to_string();
                    assert!(names.contains(&name.as_str()), "{name} has no test");
                }
            }
        }
    };
}

scenes! {
    conductor roughconductor_ggx roughconductor_beckmann roughconductor_default
    dielectric roughdielectric_ggx roughdielectric_beckmann
    plastic roughplastic null
    mask blendbsdf thindielectric grained principled principled_glass normalmap bumpmap vertex_colours
    face_attributes
    textures textured_roughness textured_light
    envmap delta_lights normals
    beams orthographic thinlens instances
}
