//! From the repeats of a cell to its figures.

use super::one_run::Run;
use super::quantities::Figures;
use super::reference::{Reference, between};
use crate::statistics::agreement::Agreement;
use crate::statistics::bias::Bias;
use crate::statistics::concentration::{kurtosis, share_of_largest};
use crate::statistics::sigmas;
use std::collections::BTreeMap;

/// Standard errors from which the square of a bias counts as an error.
const BIAS_SEEN: f64 = 2.0;
/// Sigmas of an interval that holds 95 % of normal numbers.
const INTERVAL: f64 = 1.959_964;

/// Of runs that took so many camera paths each, and stated errors from so many groups.
pub fn of(runs: &[Run], reference: &Reference, paths: u64, groups: u32) -> Figures {
    let unit = reference.unit();
    let numbers = reference.mean.len() as f64;
    let values: Vec<Vec<f64>> = runs.iter().map(Run::values).collect();
    let repeats = values.len() as f64;
    let mut deviations = Vec::with_capacity(values.len() * reference.mean.len());
    let mut of_repeat = vec![0.0; values.len()];
    for i in 0..reference.mean.len() {
        let mean = values.iter().map(|run| run[i]).sum::<f64>() / repeats;
        for (run, sum) in values.iter().zip(&mut of_repeat) {
            deviations.push(run[i] - mean);
            *sum += (run[i] - mean).powi(2);
        }
    }
    let scatter: f64 = of_repeat.iter().sum();
    let magnitudes = values.iter().flatten().map(|x| x.abs()).collect();
    let squares = deviations.iter().map(|x| x * x).collect();
    let worst = of_repeat.into_iter().fold(0.0, f64::max) / scatter;
    let (bias_squared, bias_squared_se) = Bias::new(&values, &reference.runs).mean_square();
    let variance = scatter / (repeats - 1.0) / numbers;
    let square = squared_error(variance, bias_squared, bias_squared_se);
    let size = reference.rms.map(|rms| size_bias(&values, reference, rms));
    let mut rejected = BTreeMap::new();
    for (cause, count) in runs.iter().flat_map(|run| &run.rejected) {
        *rejected.entry(cause.to_string()).or_default() += count;
    }
    let all_rejected: u64 = rejected.values().sum();
    Figures {
        rmse: square.sqrt() / unit,
        sd: variance.sqrt() / unit,
        bias_squared: bias_squared / unit.powi(2),
        bias_squared_se: bias_squared_se / unit.powi(2),
        size_bias: size.and_then(|s| known(s.0)),
        size_bias_se: size.and_then(|s| known(s.1)),
        bias_sigmas: between(&values, &reference.runs, reference.rounding),
        kurtosis: known(kurtosis(&deviations)),
        top_gradient_share: known(share_of_largest(magnitudes)),
        top_variance_share: known(share_of_largest(squares)),
        worst_repeat_share: known(worst),
        coverage: coverage(runs, reference, groups),
        not_finite: runs.iter().map(|run| run.not_finite).sum(),
        rays: runs.iter().map(|run| run.rays as f64).sum::<f64>() / repeats,
        rejected,
        rejected_share: all_rejected as f64 / (paths as f64 * repeats),
    }
}

/// Of one run. A bias that is not told from the reference's noise does not count: it would drown
/// methods with hardly any noise of their own, or take off more than they have.
fn squared_error(variance: f64, bias_squared: f64, bias_squared_se: f64) -> f64 {
    let is_seen = bias_squared > BIAS_SEEN * bias_squared_se;
    variance + if is_seen { bias_squared } else { 0.0 }
}

fn known(number: f64) -> Option<f64> {
    number.is_finite().then_some(number)
}

/// Of the size along the reference, and its standard error. What [`Agreement`] projects on has
/// noise in its square, which is taken out.
fn size_bias(ours: &[Vec<f64>], reference: &Reference, rms: f64) -> (f64, f64) {
    let runs = ours.len().min(reference.runs.len());
    let bias = Agreement::new(&ours[..runs], &reference.runs[..runs]).bias;
    let noise = 1.0 + (reference.noise() / rms).powi(2);
    (bias.value * noise, bias.error * noise)
}

/// The share of numbers whose interval holds the reference, among those where there is anything.
fn coverage(runs: &[Run], reference: &Reference, groups: u32) -> Option<f64> {
    reference.rms?;
    let width = sigmas::student(INTERVAL, f64::from(groups) - 1.0);
    let (mut held, mut all) = (0u64, 0u64);
    for run in runs {
        let pairs = run.gradient.iter().zip(&run.stderr);
        let truths = reference.mean.iter().zip(&reference.error);
        for ((value, stated), (truth, error)) in pairs.zip(truths) {
            let [value, stated] = [*value, *stated].map(f64::from);
            if value == 0.0 && truth.abs() <= reference.rounding + INTERVAL * error {
                continue;
            }
            all += 1;
            let reach = (width * stated).hypot(INTERVAL * error) + reference.rounding;
            held += u64::from((value - truth).abs() <= reach);
        }
    }
    known(held as f64 / all as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_noise_of_a_reference_is_no_error() {
        assert_eq!(squared_error(0.01, -1.0, 1.0), 0.01);
        assert_eq!(squared_error(0.01, 1.9, 1.0), 0.01);
        assert_eq!(squared_error(0.01, 2.1, 1.0), 2.11);
    }
}
