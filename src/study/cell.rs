//! What is found of one method with one number of samples on one direction.

use super::verdict::Verdict;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One direction of one scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub direction: String,
    pub symptom: String,
    /// What the file of other programs calls the scene, and which of its filters this one has.
    pub peer: String,
    pub filter: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
    pub reference: ReferenceFigures,
    pub cells: Vec<Cell>,
}

/// How sure the reference is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReferenceFigures {
    /// Root mean square of the gradient; none if nothing stands out of the noise.
    pub rms: Option<f64>,
    /// Root mean square of its standard errors, in units of `rms` (of 1 if there is none).
    pub noise: f64,
    pub ladder: super::reference::Ladder,
}

/// One method with one number of samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cell {
    pub method: String,
    pub spp: u32,
    pub repeats: usize,
    pub verdict: Verdict,
    /// None if the method refused.
    pub figures: Option<Figures>,
    /// What another run would find otherwise.
    pub times: Option<Times>,
}

/// Errors, in units of the reference's root mean square (of 1 if it has none).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Of one run, freed of the reference's noise.
    pub rmse: f64,
    /// Standard deviation of one run.
    pub sd: f64,
    /// Mean square of what averaging over the repeats would leave, freed of their own noise and of
    /// the reference's; below zero where noise makes it so.
    pub bias_squared: f64,
    pub bias_squared_se: f64,
    /// Of the gradient's size along the reference.
    pub size_bias: Option<f64>,
    pub size_bias_se: Option<f64>,
    /// How many sigmas the repeats are from the reference: as images, or in their size.
    pub bias_sigmas: f64,
    /// Of the deviations of all numbers of all repeats from their means.
    pub kurtosis: Option<f64>,
    /// Share of the largest thousandth of all numbers: in the sum of |gradient|, and in the
    /// variance.
    pub top_gradient_share: Option<f64>,
    pub top_variance_share: Option<f64>,
    /// The share of the worst repeat in the variance of all.
    pub worst_repeat_share: Option<f64>,
    /// Share of numbers whose 95 % interval holds the reference.
    pub coverage: Option<f64>,
    /// Numbers that are infinite or none at all.
    pub not_finite: u64,
    /// Of one run.
    pub rays: f64,
    /// Rejected samples of all repeats, by cause, and their share of all camera paths.
    pub rejected: BTreeMap<String, u64>,
    pub rejected_share: f64,
}

/// What a run took; medians over the repeats.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    pub seconds: f64,
    /// Of all cores together.
    pub processor_seconds: f64,
    /// The most the process held in any repeat.
    pub memory_bytes: Option<u64>,
    /// 1/(rmse² · processor seconds).
    pub efficiency: Option<f64>,
    /// Over that of finite differences with as many samples.
    pub relative_efficiency: Option<f64>,
    /// Standard deviation in equal processor time, over that of finite differences.
    pub relative_noise: Option<f64>,
}
