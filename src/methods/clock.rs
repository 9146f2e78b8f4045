//! The time of a sweep over tiles, parted into tracing and differentiating.
//!
//! Reports call these stages `primal` and `adjoint`: scripts read those keys.

use super::statistics::Statistics;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Parts the time of a sweep over tiles into tracing and differentiating, by what the threads spent
/// on each.
pub struct StageClock {
    started: Instant,
    tracing_ns: AtomicU64,
    differentiating_ns: AtomicU64,
}

impl StageClock {
    pub fn start() -> Self {
        Self {
            started: Instant::now(),
            tracing_ns: AtomicU64::new(0),
            differentiating_ns: AtomicU64::new(0),
        }
    }

    /// A thread has traced since `start`; now.
    pub fn add_tracing(&self, start: Instant) -> Instant {
        self.tracing_ns
            .fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        Instant::now()
    }

    /// A thread has differentiated since `start`.
    pub fn add_differentiating(&self, start: Instant) {
        self.differentiating_ns
            .fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// As [`StageClock::stop`], of a sweep that only traced.
    pub fn stop_tracing(self, statistics: &mut Statistics) {
        statistics.add_seconds("primal", self.started);
        statistics.tile_seconds += self.tracing_ns.into_inner() as f64 * 1e-9;
    }

    /// Hands the time since the start to the stages.
    pub fn stop(self, statistics: &mut Statistics) {
        let seconds = self.started.elapsed().as_secs_f64();
        let (tracing, differentiating) = (
            self.tracing_ns.into_inner() as f64,
            self.differentiating_ns.into_inner() as f64,
        );
        let share = tracing / (tracing + differentiating).max(1.0);
        statistics.spend("primal", seconds * share);
        statistics.spend("adjoint", seconds * (1.0 - share));
        statistics.tile_seconds += (tracing + differentiating) * 1e-9;
    }
}
