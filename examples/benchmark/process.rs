//! Runs of the release binary, and what they leave behind.

use crate::cases::Case;
use crate::statistics::Reference;
use crate::{Result, scratch};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use warpath::methods::Image;
use warpath::output::npy;

/// The binary that is measured.
pub struct Program {
    path: PathBuf,
}

/// One forward run.
pub struct ForwardRun {
    pub seconds: f64,
    /// Seconds after loading and building, before writing.
    pub traced_seconds: f64,
    pub rays: u64,
    pub peak_megabytes: f64,
    pub gradient: Vec<f32>,
    pub stderr: Vec<f32>,
}

/// One backward run.
pub struct BackwardRun {
    pub seconds: f64,
    pub numbers: usize,
    /// Norm of the stated standard error over that of the gradient.
    pub relative_error: f64,
    gradient: Vec<f32>,
    stderr: Vec<f32>,
}

impl Program {
    /// `warpath` beside the folder that this example was built into.
    pub fn find() -> Result<Self> {
        let own = std::env::current_exe()?;
        let folder = own
            .parent()
            .and_then(Path::parent)
            .ok_or("no folder above this program")?;
        let path = folder.join("warpath");
        if !path.exists() {
            return Err(format!("{} is missing: cargo build --release", path.display()).into());
        }
        Ok(Self { path })
    }

    /// One line about the processor.
    pub fn machine(&self) -> String {
        let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let model = text
            .lines()
            .find_map(|l| l.strip_prefix("model name")?.split_once(": "))
            .map_or("?", |m| m.1);
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        format!(
            "{model}, {threads} threads, warpath {}.",
            env!("CARGO_PKG_VERSION")
        )
    }

    /// The gradient image for each of the seeds 1, 2, …
    pub fn forward(
        &self,
        case: &Case,
        method: &str,
        spp: u32,
        runs: usize,
    ) -> Result<Vec<ForwardRun>> {
        (1..=runs)
            .map(|seed| {
                let folder = scratch().join("run");
                let mut command = self.command("forward", case, spp, seed, &folder);
                command.args(["--method", method]);
                for direction in &case.directions {
                    command.args(["--param", direction]);
                }
                let (seconds, report) = run(command, &folder)?;
                let of = |key: &str| report["seconds"][key].as_f64().unwrap_or(0.0);
                Ok(ForwardRun {
                    seconds,
                    traced_seconds: of("total") - of("load") - of("build") - of("write"),
                    rays: report["rays"]
                        .as_object()
                        .map_or(0, |r| r.values().filter_map(|v| v.as_u64()).sum()),
                    peak_megabytes: report["peak_memory_bytes"].as_f64().unwrap_or(0.0) / 1e6,
                    gradient: npy::read(&folder.join("gradient.npy"))?.values,
                    stderr: npy::read(&folder.join("stderr.npy"))?.values,
                })
            })
            .collect()
    }

    /// The gradient of a smooth linear loss, for each of the seeds.
    pub fn backward(
        &self,
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
                let mut command = self.command("backward", case, spp, seed, &folder);
                command
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
                let (gradient, stderr) =
                    (read(&case.tensor)?, read(&format!("{}#se", case.tensor))?);
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

    /// A run by finite differences, for a reference.
    pub fn differences(
        &self,
        case: &Case,
        spp: u32,
        seed: usize,
    ) -> Result<(warpath::output::npy::Array, Vec<f32>)> {
        let folder = scratch().join("run");
        let mut command = self.command("forward", case, spp, seed, &folder);
        command.args(["--method", "fd"]);
        for direction in &case.directions {
            command.args(["--param", direction]);
        }
        run(command, &folder)?;
        Ok((
            npy::read(&folder.join("gradient.npy"))?,
            npy::read(&folder.join("stderr.npy"))?.values,
        ))
    }

    fn command(&self, name: &str, case: &Case, spp: u32, seed: usize, folder: &Path) -> Command {
        let mut command = Command::new(&self.path);
        command
            .arg(name)
            .arg(&case.scene)
            .arg("-D")
            .arg(format!("rfilter={}", case.filter_plugin()));
        command
            .args([
                "--spp",
                &spp.to_string(),
                "--seed",
                &seed.to_string(),
                "--quiet",
                "-o",
            ])
            .arg(folder);
        command
    }
}

/// Wall seconds of the whole process, and its report.
fn run(mut command: Command, folder: &Path) -> Result<(f64, serde_json::Value)> {
    let start = Instant::now();
    let output = command
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .output()?;
    let seconds = start.elapsed().as_secs_f64();
    if !output.status.success() {
        let text = String::from_utf8_lossy(&output.stderr);
        return Err(text
            .lines()
            .find(|l| l.contains("error"))
            .unwrap_or("it failed")
            .to_string()
            .into());
    }
    let report = serde_json::from_str(&std::fs::read_to_string(folder.join("report.json"))?)?;
    Ok((seconds, report))
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
