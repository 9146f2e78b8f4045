//! One measured number.

use super::measure::Passes;

/// What is recorded of one measurement.
pub struct Number {
    pub unit: &'static str,
    /// Median, least and most.
    pub summary: [f64; 3],
    pub passes: usize,
    pub rays: Option<u64>,
}

impl Number {
    /// Times.
    pub fn milliseconds(passes: &Passes) -> Self {
        Self {
            unit: "ms",
            summary: passes.summary(|seconds| 1e3 * seconds),
            passes: passes.count(),
            rays: None,
        }
    }
}
