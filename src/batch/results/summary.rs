//! How a batch went: `report.json`.

use super::line::ResultLine;
use crate::jobs::shown::counted;
use serde::Serialize;
use std::collections::BTreeMap;

/// Slowest jobs that are named.
const SLOWEST: usize = 5;

/// A batch that has ended: `report.json`.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Summary {
    /// Jobs run, those of earlier runs not among them.
    pub jobs: usize,
    pub failed: usize,
    /// Done by an earlier run.
    pub skipped: usize,
    /// Wall-clock.
    pub seconds: f64,
    pub threads: usize,
    /// All cores together.
    pub processor_seconds: Option<f64>,
    /// What the threads spent tracing and differentiating.
    pub thread_seconds: f64,
    pub rays: u64,
    pub scene_loads: usize,
    pub memory_bytes: u64,
    pub peak_memory_bytes: Option<u64>,
    pub slowest: Vec<Slow>,
    /// How many jobs failed of what.
    pub failures: Vec<Cause>,
}

/// A job that took long.
#[derive(Clone, Debug, Serialize)]
pub struct Slow {
    pub id: String,
    pub seconds: f64,
}

/// Jobs that failed of the same thing.
#[derive(Clone, Debug, Serialize)]
pub struct Cause {
    pub code: u8,
    pub jobs: usize,
    /// Of the first of them.
    pub message: String,
}

impl Summary {
    /// Adds a job.
    pub fn add(&mut self, result: &ResultLine) {
        self.jobs += 1;
        self.rays += result.rays.values().sum::<u64>();
        self.thread_seconds += result.thread_seconds.unwrap_or(0.0);
        if !result.is_ok() {
            self.failed += 1;
            self.blame(result);
            return;
        }
        let id = result.id.clone().unwrap_or_default();
        let seconds = result.seconds.get("total").copied().unwrap_or(0.0);
        self.slowest.push(Slow { id, seconds });
        self.slowest.sort_by(|a, b| b.seconds.total_cmp(&a.seconds));
        self.slowest.truncate(SLOWEST);
    }

    fn blame(&mut self, result: &ResultLine) {
        let message = result.message.clone().unwrap_or_default();
        let same = |cause: &&mut Cause| {
            cause.code == result.code && gist(&cause.message) == gist(&message)
        };
        match self.failures.iter_mut().find(same) {
            Some(cause) => cause.jobs += 1,
            None => self.failures.push(Cause {
                code: result.code,
                jobs: 1,
                message,
            }),
        }
    }

    /// Jobs a second.
    pub fn jobs_rate(&self) -> f64 {
        self.jobs as f64 / self.seconds.max(1e-9)
    }

    /// The share of the threads' time in which a core worked.
    pub fn utilisation(&self) -> Option<f64> {
        let available = self.seconds * self.threads as f64;
        self.processor_seconds
            .map(|used| used / available.max(1e-9))
    }

    /// In a few lines.
    pub fn lines(&self) -> Vec<String> {
        let mut lines = vec![format!(
            "{} in {:.2} s: {:.2} jobs/s, {:.2} Mrays/s; {} failed, {} done before",
            counted(self.jobs, "job"),
            self.seconds,
            self.jobs_rate(),
            self.rays as f64 * 1e-6 / self.seconds.max(1e-9),
            self.failed,
            self.skipped
        )];
        if !self.slowest.is_empty() {
            let slowest: Vec<String> = self
                .slowest
                .iter()
                .map(|job| format!("{} ({:.2} s)", job.id, job.seconds))
                .collect();
            lines.push(format!("slowest: {}", slowest.join(", ")));
        }
        lines.extend(self.failures.iter().map(|cause| {
            format!(
                "failed with code {}: {} such as {}",
                cause.code, cause.jobs, cause.message
            )
        }));
        lines
    }
}

/// The message without numbers, which tell lines, places and sizes apart.
fn gist(message: &str) -> BTreeMap<usize, String> {
    let words = message.split(|c: char| c.is_ascii_digit() || c.is_whitespace());
    let words = words.filter(|word| !word.is_empty());
    words.map(str::to_string).enumerate().collect()
}
