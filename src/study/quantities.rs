//! What is measured of a method, in numbers.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Errors, in units of the reference's root mean square (of 1 if it has none).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Of one run: its noise, and the bias as far as that is seen beside the reference's noise.
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
