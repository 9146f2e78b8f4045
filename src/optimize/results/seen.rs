//! Textures compared with those of a scene that is known, as far as the views see them.

use super::errors::{ParameterError, distance, wanted};
use crate::jobs::failure::Failure;
use crate::methods::{EngineError, Groups, Method, Objective, Prepared, Progress, Settings};
use crate::optimize::problem::view::View;
use crate::optimize::problem::{Problem, seeds};
use crate::optimize::run::state::State;
use crate::picture::Image;
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter, Target};

/// Says of textures how far they are off where texels count by how much the fitted views change
/// with them: texels that no view shows do not count at all.
pub fn measure(
    problem: &Problem,
    state: &State,
    progress: &dyn Progress,
    errors: &mut [ParameterError],
) -> Result<(), Failure> {
    let Some(truth) = &problem.truth else {
        return Ok(());
    };
    let values = state.values(problem);
    for (variable, values) in problem.variables.iter().zip(values) {
        let key = &variable.parameter.key;
        let Some(error) = errors.iter_mut().find(|e| e.key == *key) else {
            continue;
        };
        let (Ok(parameter), Some(wanted)) =
            (parameters::find(truth, key), wanted(problem, variable))
        else {
            continue;
        };
        match parameter.target {
            Some(Target::Texels(t)) if truth.textures[t].texels.len() > 1 => (),
            _ => continue,
        }
        let weights = weights(problem, truth, &parameter, progress)?;
        let start = variable.start(&problem.base.scene)?;
        let now: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        error.seen_start = Some(distance(&start, &wanted, Some(&weights)));
        error.seen_end = Some(distance(&now, &wanted, Some(&weights)));
    }
    Ok(())
}

/// By how much the sum of a view's pixels changes with each number, added up over the views.
fn weights(
    problem: &Problem,
    truth: &Scene,
    parameter: &Parameter,
    progress: &dyn Progress,
) -> Result<Vec<f64>, Failure> {
    let machine = &problem.machine;
    let cancelled = || progress.cancelled();
    let prepared = Prepared::with_workers(truth, &machine.workers, machine.backend, &cancelled)
        .map_err(failed)?;
    let mut weights = vec![0.0; parameter.len()];
    for (number, view) in problem.views.iter().enumerate() {
        let settings = Settings {
            spp: problem.config.output.spp,
            seed: seeds::of(problem.config.seed, [seeds::SEEN, number as u64, 0]),
            resolution: view.resolution,
            sensor: view.sensor,
            // All numbers in one pass.
            method: match problem.settings.method.has_reverse_mode() {
                true => problem.settings.method,
                false => Method::Reparam,
            },
            groups: Some(Groups {
                count: 1,
                only: None,
            }),
            ..problem.settings.clone()
        };
        let counts = counts(problem, view);
        let asked = std::slice::from_ref(parameter);
        let objective = Objective::Adjoint(&counts);
        let done = prepared
            .backward(&settings, asked, &objective, progress)
            .map_err(failed)?;
        let slopes = done.gradient.by(truth, parameter);
        for (weight, slope) in weights.iter_mut().zip(slopes) {
            *weight += f64::from(slope.abs());
        }
    }
    Ok(weights)
}

/// One where a pixel counts.
fn counts(problem: &Problem, view: &View) -> Image {
    let (target, weights) = problem.counted(view, 1);
    let pixels = match weights {
        Some(weights) => weights.iter().map(|&w| [w; 3]).collect(),
        None => vec![[1.0; 3]; target.pixels.len()],
    };
    Image { pixels, ..target }
}

fn failed(error: EngineError) -> Failure {
    Failure::from_engine(error, None)
}
