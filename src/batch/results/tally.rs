//! How a batch goes.

use super::line::ResultLine;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

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

    /// A job is so many millionths further.
    pub fn go_on(&self, millionths: u64) {
        self.partly.fetch_add(millionths, Ordering::Relaxed);
    }

    /// So many of them are counted no more.
    pub fn take_back(&self, millionths: u64) {
        self.partly.fetch_sub(millionths, Ordering::Relaxed);
    }

    /// A job has ended.
    pub fn end(&self, result: &ResultLine) {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.failed
            .fetch_add((!result.is_ok()).into(), Ordering::Relaxed);
        let rays = result.rays.values().sum();
        self.rays.fetch_add(rays, Ordering::Relaxed);
    }
}
