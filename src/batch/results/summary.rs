//! How a batch goes, and how it went.

use super::line::ResultLine;
use crate::jobs::shown::counted;
use serde::Serialize;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Slowest jobs that are named.
const SLOWEST: usize = 5;

/// What has been done so far; threads add to it.
#[derive(Debug)]
pub struct Tally {
    pub started: Instant,
    /// `None` for a stream.
    pub total: Option<usize>,
    done: AtomicU64,
    failed: AtomicU64,
    rays: AtomicU64,
    /// Millionths of jobs that are running.
    partly: AtomicU64,
}

impl Tally {
    pub fn start(total: Option<usize>) -> Self {
        Self {
            started: Instant::now(),
            total,
            done: AtomicU64::new(0),
            failed: AtomicU64::new(0),
            rays: AtomicU64::new(0),
            partly: AtomicU64::new(0),
        }
    }

    /// Jobs that have ended.
    pub fn done(&self) -> u64 {
        self.done.load(Ordering::Relaxed)
    }

    /// Those of them that failed.
    pub fn failed(&self) -> u64 {
        self.failed.load(Ordering::Relaxed)
    }

    /// Jobs a second.
    pub fn jobs_rate(&self) -> f64 {
        self.done() as f64 / self.seconds()
    }

    /// Rays a second, of jobs that have ended.
    pub fn rays_rate(&self) -> f64 {
        self.rays.load(Ordering::Relaxed) as f64 / self.seconds()
    }

    /// Seconds left, if the jobs to come are like those so far.
    pub fn seconds_left(&self) -> Option<f64> {
        let so_far = self.done() as f64 + 1e-6 * self.partly.load(Ordering::Relaxed) as f64;
        let left = self.total? as f64 - so_far;
        (so_far > 0.0).then(|| left.max(0.0) * self.seconds() / so_far)
    }

    fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64().max(1e-9)
    }

    pub fn go_on(&self, millionths: u64) {
        self.partly.fetch_add(millionths, Ordering::Relaxed);
    }

    pub fn take_back(&self, millionths: u64) {
        self.partly.fetch_sub(millionths, Ordering::Relaxed);
    }

    pub fn end(&self, result: &ResultLine) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.failed
            .fetch_add((!result.is_ok()).into(), Ordering::Relaxed);
        let rays = result.rays.values().sum();
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }
}

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
