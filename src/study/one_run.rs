//! One run of a method.

use crate::jobs::failure::Failure;
use crate::methods::ForwardGradient;
use std::collections::BTreeMap;

/// One run of a cell.
pub struct Run {
    pub gradient: Vec<f32>,
    pub stderr: Vec<f32>,
    pub rejected: BTreeMap<&'static str, u64>,
    pub rays: u64,
    /// Numbers that were infinite or none at all; zeros stand in their place.
    pub not_finite: u64,
    pub seconds: f64,
    pub processor_seconds: f64,
    pub memory_bytes: Option<u64>,
}

impl Run {
    /// In double precision.
    pub fn values(&self) -> Vec<f64> {
        self.gradient.iter().map(|x| f64::from(*x)).collect()
    }
}

impl Run {
    /// Of what was made; its times come later.
    pub fn of(made: ForwardGradient) -> Result<Self, Failure> {
        let none = || Failure::System("a run gave no standard errors".into());
        let mut gradient = made.gradient.pixels.into_flattened();
        let mut stderr = made.stderr.ok_or_else(none)?.pixels.into_flattened();
        let mut not_finite = 0;
        for number in gradient.iter_mut().chain(&mut stderr) {
            if !number.is_finite() {
                not_finite += 1;
                *number = 0.0;
            }
        }
        Ok(Self {
            gradient,
            stderr,
            rejected: made.statistics.rejected,
            rays: made.statistics.rays.values().sum(),
            not_finite,
            seconds: 0.0,
            processor_seconds: 0.0,
            memory_bytes: None,
        })
    }
}
