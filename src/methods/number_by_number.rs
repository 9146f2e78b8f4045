//! Reverse mode by differences: one difference for every number that is asked for.
//!
//! With w the derivative of the objective by the image, the derivative by a number θᵢ is ⟨w, ∂I/∂θᵢ⟩,
//! and the image's derivative along θᵢ is a difference ([`super::differences`]). That is two
//! renderings or four for each number, which is worth it for a few numbers where stored paths have much
//! more noise: smooth metal and glass, scanned meshes.

use super::differences::{Displaced, Part, Steps};
use super::error::EngineError;
use super::estimators::Method;
use super::objective::{Evaluation, Objective, check_size, evaluate, inner_product};
use super::prepared::Prepared;
use super::progress::Progress;
use super::render::render;
use super::results::BackwardGradient;
use super::settings::{Groups, Settings};
use crate::gradient::terms::Terms;
use crate::scene::parameters::{self, Gradient, Parameter};
use crate::scene::{Rgb, SceneDifferential};
use crate::statistics::estimate::Estimate;

/// Numbers that may be asked for at most. More would take days, and were hardly meant.
const MOST_NUMBERS: usize = 10_000;

/// The derivative of an objective by all numbers of the parameters.
///
/// If it was `auto` that came to this, only what moves edges is done by differences, and the rest,
/// such as the texels of a picture, along paths in one pass.
pub fn backward(
    prepared: &Prepared,
    settings: &Settings,
    wanted: &[Parameter],
    objective: &Objective,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let (differenced, along_paths) = parted(prepared, settings, wanted)?;
    let numbers = numbers(&differenced);
    if numbers > MOST_NUMBERS {
        return Err(EngineError::Refused(format!(
            "{} would take one for each of {numbers} numbers; take reparam, which takes one pass for all",
            settings.method.title()
        )));
    }
    let evaluation = evaluate(prepared, settings, objective, progress)?;
    let mut done = rest(prepared, settings, &along_paths, &evaluation, progress)?;
    check_size(&evaluation.adjoint, [done.image.width, done.image.height])?;
    if !matches!(objective, Objective::Adjoint(_)) {
        done.loss = evaluation.loss;
        done.image = evaluation.image.unwrap_or(done.image);
    }
    done.statistics.notes.push(format!(
        "{}, one for each of {numbers} numbers",
        settings.method.title()
    ));
    let adjoint = &evaluation.adjoint.pixels;
    let displaced = Displaced::new(prepared, settings);
    let mut finished = 0;
    for parameter in differenced {
        let mut of_groups = vec![vec![0.0; parameter.len()]; done.groups.len()];
        for number in 0..parameter.len() {
            let progress = Part {
                whole: progress,
                part: finished,
                parts: numbers as u64,
            };
            let mut one = vec![0.0; parameter.len()];
            one[number] = 1.0;
            let direction = [(parameter.clone(), one)];
            let steps = Steps::usual(prepared, settings, &direction)?;
            displaced.render(&direction, &steps, &progress, &mut done.statistics, |it| {
                for (sums, image) in of_groups.iter_mut().zip(&it.groups) {
                    sums[number] += it.weight * weighed(image, adjoint);
                }
            })?;
            finished += 1;
        }
        let Some(target) = parameter.target else {
            continue;
        };
        let mean = |i| Estimate::mean_of(of_groups.iter().map(|group| group[i])).value as f32;
        let mean = (0..parameter.len()).map(mean).collect();
        done.gradient.numbers.push((target, mean));
        for (gradient, sums) in done.groups.iter_mut().zip(&of_groups) {
            let sums = sums.iter().map(|x| *x as f32).collect();
            gradient.numbers.push((target, sums));
        }
    }
    Ok(done)
}

/// How many numbers these are.
pub fn numbers(parameters: &[Parameter]) -> usize {
    parameters.iter().map(Parameter::len).sum()
}

/// What is done by differences, and what along paths.
pub fn parted(
    prepared: &Prepared,
    settings: &Settings,
    wanted: &[Parameter],
) -> Result<(Vec<Parameter>, Vec<Parameter>), EngineError> {
    let (mut differenced, mut along_paths) = (Vec::new(), Vec::new());
    for parameter in wanted {
        let request = parameters::wanted(
            prepared.scene,
            std::slice::from_ref(parameter),
            settings.sensor,
        )?;
        let goes_along = settings.is_decided() && !request.moves_edges(prepared.scene);
        match goes_along {
            true => along_paths.push(parameter.clone()),
            false => differenced.push(parameter.clone()),
        }
    }
    Ok((differenced, along_paths))
}

/// What needs no differences: the gradient by what moves no edges, and the image.
fn rest(
    prepared: &Prepared,
    settings: &Settings,
    parameters: &[Parameter],
    evaluation: &Evaluation,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let adjoint = &evaluation.adjoint;
    let mut done = match parameters.is_empty() {
        true => {
            let own_groups = match settings.groups() {
                Groups { only: Some(_), .. } => 1,
                Groups { count, .. } => count as usize,
            };
            let none = Gradient::from(SceneDifferential::none(prepared.scene));
            let rendering = render(prepared, settings, progress)?;
            BackwardGradient {
                loss: inner_product(&rendering.image, adjoint),
                image: rendering.image,
                gradient: none.clone(),
                groups: vec![none; own_groups],
                terms: Terms::new(prepared.scene.meshes.len(), prepared.scene.textures.len()),
                statistics: rendering.statistics,
            }
        }
        false => {
            let settings = Settings {
                method: Method::Auto,
                ..settings.clone()
            };
            let request = parameters::wanted(prepared.scene, parameters, settings.sensor)?;
            let objective = Objective::Adjoint(adjoint);
            super::backward::backward(prepared, &settings, &request, &objective, progress)?
        }
    };
    done.statistics.absorb(&evaluation.statistics);
    Ok(done)
}

fn weighed(image: &[Rgb], adjoint: &[Rgb]) -> f64 {
    let pairs = image.as_flattened().iter().zip(adjoint.as_flattened());
    pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}
