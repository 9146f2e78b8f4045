//! One step of an optimisation.

use super::order::views_of;
use super::record::Record;
use super::state::State;
use super::stop;
use crate::jobs::failure::Failure;
use crate::methods::Progress;
use crate::optimize::problem::Problem;
use crate::optimize::results::errors;
use crate::optimize::shape::watch;
use crate::optimize::step::{Evaluation, Look, Ranks, Sampling, evaluate};
use std::time::Instant;

/// Steps between two looks at the noise of the gradient.
const STEPS_PER_LOOK: u64 = 5;

/// Makes the next step of `state`, and returns what was found on the way.
pub fn advance(
    problem: &Problem,
    state: &mut State,
    ranks: &dyn Ranks,
    progress: &dyn Progress,
) -> Result<Evaluation, Failure> {
    let config = &problem.config;
    let step = state.step;
    let views = views_of(config, problem.views.len(), step);
    let looks = looks(problem, &views);
    let sampling = sampling(problem, state);
    let values = state.values(problem);
    let mut found = evaluate(problem, &values, &looks, &sampling, ranks, progress)?;
    let start = Instant::now();
    let mut record = record(problem, &found, &sampling, views);
    record.off_truth = errors::now(problem, &values);
    let gradients: Vec<Vec<f64>> = (problem.variables.iter().zip(&state.latents))
        .zip(&found.gradients)
        .map(|((variable, latent), gradient)| variable.pull_back(latent, gradient))
        .collect();
    let is_finite = gradients.iter().flatten().all(|g| g.is_finite());
    record.refused = !is_finite || record.loss.is_none();
    if record.refused {
        state.refused_in_turn += 1;
        if state.refused_in_turn == stop::MOST_REFUSED {
            state.ended = Some(format!(
                "{} steps one after another had a loss or a gradient that was not finite",
                stop::MOST_REFUSED
            ));
        }
    } else {
        state.refused_in_turn = 0;
        take(problem, state, &gradients, &mut record);
        let moved = state.values(problem);
        record.inverted = watch::inverted(problem, &values, &moved);
    }
    found.statistics.add_seconds("solve", start);
    state.history.push(record);
    state.step += 1;
    adapt(problem, state);
    if state.ended.is_none() {
        state.ended = stop::reason(config, &state.history);
    }
    Ok(found)
}

/// The images of some views, and what their shapes cover if that is compared.
fn looks(problem: &Problem, views: &[usize]) -> Vec<Look> {
    let kinds: &[bool] = if problem.silhouette.is_some() {
        &[false, true]
    } else {
        &[false]
    };
    let each = |&view: &usize| {
        kinds
            .iter()
            .map(move |&silhouette| Look { view, silhouette })
    };
    views.iter().flat_map(each).collect()
}

fn sampling(problem: &Problem, state: &State) -> Sampling {
    let render = &problem.config.render;
    let (step, steps) = (state.step, problem.config.steps);
    let spp = render.spp.at(step, steps) as u32;
    let loss_spp = render
        .loss_spp
        .as_ref()
        .map_or(spp, |own| own.at(step, steps) as u32);
    let more = |spp: u32| match render.adaptive {
        Some(adaptive) => {
            let wanted = u64::from(spp) << state.doublings;
            wanted.min(adaptive.most_spp.max(spp).into()) as u32
        }
        None => spp,
    };
    Sampling {
        step,
        spp: problem.even(more(spp)),
        loss_spp: problem.even(more(loss_spp)),
    }
}

fn record(problem: &Problem, found: &Evaluation, sampling: &Sampling, views: Vec<usize>) -> Record {
    let length = |numbers: &[f64]| numbers.iter().map(|g| g * g).sum::<f64>();
    let noise: Vec<f64> = found.variances.iter().map(|v| v.iter().sum()).collect();
    let pairs = found.gradients.iter().zip(&noise);
    Record {
        step: sampling.step,
        loss: Some(found.loss.value + found.penalty).filter(|loss| loss.is_finite()),
        error: found.loss.error.filter(|error| error.is_finite()),
        floor: found.loss.floor.filter(|floor| floor.is_finite()),
        penalty: found.penalty,
        spp: sampling.spp,
        loss_spp: sampling.loss_spp,
        downscale: problem.downscale(sampling.step) as u32,
        signal: pairs.map(|(g, noise)| finite(length(g) - noise)).collect(),
        noise: noise.into_iter().map(finite).collect(),
        off_truth: Vec::new(),
        views,
        held: 0,
        shortened: 0,
        inverted: 0,
        refused: false,
    }
}

/// JSON has no other numbers.
fn finite(number: f64) -> f64 {
    if number.is_finite() { number } else { 0.0 }
}

/// Moves the latent numbers.
fn take(problem: &Problem, state: &mut State, gradients: &[Vec<f64>], record: &mut Record) {
    for (i, variable) in problem.variables.iter().enumerate() {
        let rates = variable.rates(&problem.config, state.step);
        let latent = &mut state.latents[i];
        let shortened = state.memories[i].step(&rates, latent, &gradients[i]);
        record.shortened += u32::from(shortened);
        record.held += variable.hold(latent) as u64;
    }
}

/// More samples where noise hides the gradient, fewer where it does not: the norm test of
/// \[Byrd2012\], over the last steps.
fn adapt(problem: &Problem, state: &mut State) {
    let Some(adaptive) = problem.config.render.adaptive else {
        return;
    };
    if !state.step.is_multiple_of(STEPS_PER_LOOK) {
        return;
    }
    let last = state.history.len().saturating_sub(STEPS_PER_LOOK as usize);
    let Some(ratio) = Record::noise_to_signal(&state.history[last..]) else {
        return;
    };
    let newest = state.history.last().map_or(0, |record| record.spp);
    if ratio > adaptive.noise_to_signal && newest < adaptive.most_spp {
        state.doublings += 1;
    } else if ratio < 0.25 * adaptive.noise_to_signal {
        state.doublings = state.doublings.saturating_sub(1);
    }
}
