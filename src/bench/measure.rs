//! Times, as medians with their spread.

use serde::Serialize;
use std::time::Instant;

/// One number of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    pub case: String,
    pub triangles: usize,
    /// What was done: `build`, `primary`, `gradient`, …
    pub what: String,
    /// As typed after `--backend`.
    pub backend: String,
    /// Whether nothing leaks at edges.
    pub robust: bool,
    pub threads: usize,
    pub unit: &'static str,
    pub median: f64,
    /// The least and the most of all passes.
    pub low: f64,
    pub high: f64,
    pub passes: usize,
    /// Rays that met something, or that a gradient took, in one pass: what was done, for comparing.
    pub rays: Option<u64>,
}

/// Seconds of several passes, in ascending order; at least one.
#[derive(Clone, Debug)]
pub struct Passes(Vec<f64>);

/// How long to go on.
#[derive(Clone, Copy, Debug)]
pub struct Budget {
    pub seconds: f64,
}

impl Budget {
    /// Fewer passes have no spread to speak of.
    const LEAST_PASSES: usize = 3;
    /// But what takes longer than this many budgets is not done again.
    const PATIENCE: f64 = 8.0;

    /// Repeats `work`, which says how many seconds of it count.
    pub fn repeat<E>(self, mut work: impl FnMut() -> Result<f64, E>) -> Result<Passes, E> {
        let start = Instant::now();
        let mut seconds = Vec::new();
        loop {
            seconds.push(work()?);
            let spent = start.elapsed().as_secs_f64();
            let enough = seconds.len() >= Self::LEAST_PASSES && spent >= self.seconds;
            if enough || spent >= Self::PATIENCE * self.seconds {
                seconds.sort_by(f64::total_cmp);
                return Ok(Passes(seconds));
            }
        }
    }
}

impl Passes {
    /// Median, least and most of a function of the seconds.
    pub fn summary(&self, of: impl Fn(f64) -> f64) -> [f64; 3] {
        let n = self.0.len();
        let median = (self.0[(n - 1) / 2] + self.0[n / 2]) / 2.0;
        let ends = [of(self.0[0]), of(self.0[n - 1])];
        [of(median), ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    pub fn count(&self) -> usize {
        self.0.len()
    }
}

/// Seconds that `work` takes, and what it gives.
pub fn timed<T>(work: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let done = work();
    (start.elapsed().as_secs_f64(), done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_have_their_spread() {
        let mut left = vec![4.0, 1.0, 2.0, 8.0];
        let budget = Budget { seconds: 0.0 };
        let passes = budget.repeat(|| left.pop().ok_or(())).unwrap();
        // Out of patience at once.
        assert_eq!((passes.count(), passes.summary(|s| s)), (1, [8.0; 3]));
        let passes = Passes(vec![1.0, 2.0, 4.0, 8.0]);
        assert_eq!(passes.summary(|s| 12.0 / s), [4.0, 1.5, 12.0]);
    }
}
