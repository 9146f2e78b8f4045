//! When to end before the last step.

use super::record::Record;
use crate::optimize::config::Config;
use crate::statistics::estimate::Estimate;

/// Steps over which a loss is compared with its noise.
const STEPS_AT_NOISE: usize = 10;
/// Above what its own noise explains, a loss may keep this share of it: targets are noisy too.
const SHARE_OF_NOISE: f64 = 0.1;
/// Steps refused one after another before giving up.
pub const MOST_REFUSED: u32 = 10;

/// Why the run should end now, if it should.
pub fn reason(config: &Config, history: &[Record]) -> Option<String> {
    let last = history.last()?;
    let finest = config.render.downscale.at(config.steps - 1, config.steps) as u32;
    if last.downscale != finest {
        return None;
    }
    let same: Vec<&Record> = history
        .iter()
        .rev()
        .take_while(|r| r.downscale == finest)
        .filter(|r| r.loss.is_some())
        .collect();
    below(config, &same)
        .or_else(|| at_noise(config, &same))
        .or_else(|| at_rest(config, &same))
}

fn below(config: &Config, newest_first: &[&Record]) -> Option<String> {
    let below = config.stop.below?;
    let loss = newest_first.first()?.loss?;
    (loss < below).then(|| format!("the loss, {loss:.4e}, is below {below}"))
}

fn at_noise(config: &Config, newest_first: &[&Record]) -> Option<String> {
    if !config.stop.at_noise || newest_first.len() < STEPS_AT_NOISE {
        return None;
    }
    let steps = &newest_first[..STEPS_AT_NOISE];
    let excess: Option<Vec<f64>> = steps.iter().map(|r| Some(r.loss? - r.floor?)).collect();
    let floors: Option<Vec<f64>> = steps.iter().map(|r| r.floor).collect();
    let (excess, floor) = (Estimate::mean(&excess?), Estimate::mean(&floors?).value);
    (excess.value < 2.0 * excess.error + SHARE_OF_NOISE * floor).then(|| {
        format!(
            "the loss is at its noise: {:.3e} ± {:.1e} above the {floor:.3e} that noise alone makes",
            excess.value, excess.error
        )
    })
}

fn at_rest(config: &Config, newest_first: &[&Record]) -> Option<String> {
    let patience = config.stop.patience? as usize;
    if newest_first.len() < 2 * patience {
        return None;
    }
    let mean = |records: &[&Record]| {
        let losses: Vec<f64> = records.iter().filter_map(|r| r.loss).collect();
        Estimate::mean(&losses)
    };
    let (now, before) = (
        mean(&newest_first[..patience]),
        mean(&newest_first[patience..2 * patience]),
    );
    let fallen = before.value - now.value;
    let error = now.error.hypot(before.error);
    (fallen < 2.0 * error).then(|| {
        format!("in {patience} steps the loss has fallen by {fallen:.2e} ± {error:.1e}, which is nothing for sure")
    })
}
