//! What is remembered of a step: a line of `loss.csv`.

use serde::{Deserialize, Serialize};

/// What is remembered of a step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Record {
    /// From 0.
    pub step: u64,
    /// Before the step was made; none if it was not finite.
    pub loss: Option<f64>,
    /// Its standard error.
    pub error: Option<f64>,
    /// What noise alone would make it.
    pub floor: Option<f64>,
    /// Total variation, with its weight.
    pub penalty: f64,
    pub spp: u32,
    pub loss_spp: u32,
    pub downscale: u32,
    /// By variable: the square of the gradient's length without what noise adds to it, and the
    /// square of its standard error.
    pub signal: Vec<f64>,
    pub noise: Vec<f64>,
    /// By variable: how far it is from the known scene's before the step (RMS), where that is
    /// known.
    pub off_truth: Vec<Option<f64>>,
    /// Indices of the views looked at.
    pub views: Vec<usize>,
    /// Numbers held at a bound.
    pub held: u64,
    /// Variables whose step was shortened.
    pub shortened: u32,
    /// Faces that turned over.
    pub inverted: u64,
    /// The step was not made, since something was not finite.
    pub refused: bool,
}

impl Record {
    /// The noise of the gradient over its signal, of the variable in which it is largest.
    pub fn noise_to_signal(records: &[Record]) -> Option<f64> {
        let variables = records.first()?.signal.len();
        let sum = |of: &dyn Fn(&Record) -> f64| records.iter().map(of).sum::<f64>();
        let ratio = |i: usize| {
            let signal = sum(&|r| r.signal.get(i).copied().unwrap_or(0.0)).max(0.0);
            let noise = sum(&|r| r.noise.get(i).copied().unwrap_or(0.0));
            match noise > 0.0 {
                true => (noise / signal).sqrt(),
                false => 0.0,
            }
        };
        (0..variables).map(ratio).reduce(f64::max)
    }
}
