//! Runs of the cases.

use crate::Result;
use crate::cases::Case;
use crate::shared::accuracy::Reference;
use crate::shared::program::{Forward, ForwardRun, Program, run};
use std::path::PathBuf;
use std::process::Command;
use warpath::methods::Image;
use warpath::output::npy;

/// One backward run.
pub struct BackwardRun {
    pub seconds: f64,
    pub numbers: usize,
    /// Norm of the stated standard error over that of the gradient.
    pub relative_error: f64,
    gradient: Vec<f32>,
    stderr: Vec<f32>,
}

pub fn scratch() -> PathBuf {
    PathBuf::from("out/benchmark")
}

fn one(program: &Program, case: &Case, method: &str, spp: u32, seed: usize) -> Result<ForwardRun> {
    let what = Forward {
        scene: &case.scene,
        defines: vec![case.filter_define()],
        directions: &case.directions,
        method,
        spp,
        seed,
        resolution: None,
    };
    program.forward(&what, &scratch().join("run"))
}

/// The gradient image for each of the seeds 1, 2, …
pub fn forward(
    program: &Program,
    case: &Case,
    method: &str,
    spp: u32,
    runs: usize,
) -> Result<Vec<ForwardRun>> {
    (1..=runs)
        .map(|seed| one(program, case, method, spp, seed))
        .collect()
}

/// A run by finite differences, for a reference.
pub fn differences(program: &Program, case: &Case, spp: u32, seed: usize) -> Result<ForwardRun> {
    one(program, case, "fd", spp, seed)
}

/// The gradient of a smooth linear loss, for each of the seeds.
pub fn backward(
    program: &Program,
    case: &Case,
    spp: u32,
    runs: usize,
    reference: &Reference,
) -> Result<Vec<BackwardRun>> {
    let adjoint = scratch().join("adjoint.npy");
    npy::write_image(&adjoint, &waves(reference.size))?;
    (1..=runs)
        .map(|seed| {
            let folder = scratch().join("run");
            let mut command = Command::new(&program.path);
            command
                .arg("backward")
                .arg(&case.scene)
                .args(["-D", &case.filter_define(), "--spp", &spp.to_string()])
                .args(["--seed", &seed.to_string(), "--quiet", "-o"])
                .arg(&folder)
                .args(["--param", &case.tensor, "--adjoint"])
                .arg(&adjoint);
            let (seconds, _) = run(command, &folder)?;
            let bytes = std::fs::read(folder.join("gradients.safetensors"))?;
            let tensors = safetensors::SafeTensors::deserialize(&bytes)?;
            let read = |name: &str| -> Result<Vec<f32>> {
                let data = tensors.tensor(name)?.data();
                Ok(data
                    .as_chunks::<4>()
                    .0
                    .iter()
                    .map(|b| f32::from_le_bytes(*b))
                    .collect())
            };
            let (gradient, stderr) = (read(&case.tensor)?, read(&format!("{}#se", case.tensor))?);
            Ok(BackwardRun {
                seconds,
                numbers: gradient.len(),
                relative_error: norm(&stderr) / norm(&gradient),
                gradient,
                stderr,
            })
        })
        .collect()
}

/// Smooth weights of both signs on the pixels: what the linear loss multiplies the image with.
fn waves([width, height]: [usize; 2]) -> Image {
    let wave = |x: usize, y: usize, c: usize| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        (9.0 * u + 4.0 * v + c as f32).sin() + (5.0 * u - 8.0 * v + 2.0 * c as f32).cos()
    };
    let pixels = (0..width * height)
        .map(|i| std::array::from_fn(|c| wave(i % width, i / width, c)))
        .collect();
    Image {
        width,
        height,
        pixels,
    }
}

fn norm(values: &[f32]) -> f64 {
    values
        .iter()
        .map(|x| (*x as f64).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Spread of the runs over what they state as their standard error; 1 if the errors are honest.
pub fn spread_over_error(runs: &[BackwardRun]) -> f64 {
    let n = runs.len() as f64;
    let (mut variance, mut stated) = (0.0, 0.0);
    for i in 0..runs[0].gradient.len() {
        let mean = runs.iter().map(|r| r.gradient[i] as f64).sum::<f64>() / n;
        variance += runs
            .iter()
            .map(|r| (r.gradient[i] as f64 - mean).powi(2))
            .sum::<f64>()
            / (n - 1.0);
        stated += runs
            .iter()
            .map(|r| (r.stderr[i] as f64).powi(2))
            .sum::<f64>()
            / n;
    }
    (variance / stated).sqrt()
}
