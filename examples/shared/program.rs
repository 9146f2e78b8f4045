//! Runs of the release binary, as a user would start it.

use crate::Result;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;
use warpath::output::npy;

/// The binary that is measured.
pub struct Program {
    pub path: PathBuf,
}

/// A `warpath forward`.
pub struct Forward<'a> {
    pub scene: &'a Path,
    /// NAME=VALUE
    pub defines: Vec<String>,
    /// KEY=TANGENT
    pub directions: &'a [String],
    pub method: &'a str,
    pub spp: u32,
    pub seed: usize,
    /// WxH, if it is not to be the scene's.
    pub resolution: Option<&'a str>,
}

/// What it left behind.
pub struct ForwardRun {
    /// Of the whole process.
    pub seconds: f64,
    /// Seconds after loading and building, before writing.
    pub traced_seconds: f64,
    pub rays: u64,
    pub peak_megabytes: f64,
    pub scene_hash: String,
    /// Width and height.
    pub size: [usize; 2],
    pub gradient: Vec<f32>,
    pub stderr: Vec<f32>,
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

    /// The gradient image, written into `folder`.
    pub fn forward(&self, what: &Forward, folder: &Path) -> Result<ForwardRun> {
        let mut command = Command::new(&self.path);
        command.args(what.arguments()).arg("-o").arg(folder);
        let (seconds, report) = run(command, folder)?;
        ForwardRun::read(folder, seconds, &report)
    }
}

impl Forward<'_> {
    /// All but where the files go.
    pub fn arguments(&self) -> Vec<String> {
        let mut arguments = vec!["forward".into(), self.scene.display().to_string()];
        for define in &self.defines {
            arguments.extend(["-D".into(), define.clone()]);
        }
        for direction in self.directions {
            arguments.extend(["--param".into(), direction.clone()]);
        }
        arguments.extend(["--method", self.method].map(String::from));
        arguments.extend(["--spp".into(), self.spp.to_string()]);
        arguments.extend(["--seed".into(), self.seed.to_string()]);
        if let Some(size) = self.resolution {
            arguments.extend(["--resolution", size].map(String::from));
        }
        arguments.push("--quiet".into());
        arguments
    }
}

impl ForwardRun {
    /// The files of a run that took `seconds`.
    fn read(folder: &Path, seconds: f64, report: &serde_json::Value) -> Result<Self> {
        let of = |key: &str| report["seconds"][key].as_f64().unwrap_or(0.0);
        let gradient = npy::read(&folder.join("gradient.npy"))?;
        let &[height, width, 3] = gradient.shape.as_slice() else {
            return Err("a gradient that is no image".into());
        };
        Ok(Self {
            seconds,
            traced_seconds: of("total") - of("load") - of("build") - of("write"),
            rays: report["rays"]
                .as_object()
                .map_or(0, |r| r.values().filter_map(|v| v.as_u64()).sum()),
            peak_megabytes: report["peak_memory_bytes"].as_f64().unwrap_or(0.0) / 1e6,
            scene_hash: report["scene"]["hash"].as_str().unwrap_or_default().into(),
            size: [width, height],
            gradient: gradient.values,
            stderr: npy::read(&folder.join("stderr.npy"))?.values,
        })
    }

    /// What an earlier run left in `folder`.
    pub fn kept(folder: &Path) -> Result<Self> {
        let report = report(folder)?;
        Self::read(
            folder,
            report["seconds"]["total"].as_f64().unwrap_or(0.0),
            &report,
        )
    }
}

/// Wall seconds of the whole process, and its report. What it says on failing becomes the error.
pub fn run(mut command: Command, folder: &Path) -> Result<(f64, serde_json::Value)> {
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
    Ok((seconds, report(folder)?))
}

fn report(folder: &Path) -> Result<serde_json::Value> {
    let text = std::fs::read_to_string(folder.join("report.json"))?;
    Ok(serde_json::from_str(&text)?)
}

/// The middle value.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        (values[half - 1] + values[half]) / 2.0
    }
}
