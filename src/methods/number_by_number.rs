//! Reverse mode by differences: one difference for every number that is asked for.
//!
//! With w the derivative of the objective by the image, the derivative by a number θᵢ is ⟨w,
//! ∂I/∂θᵢ⟩, and the image's derivative along θᵢ is a difference ([`super::differences`]). That is
//! four renderings for each number, which is worth it for a few numbers where stored paths have
//! much more noise: smooth metal and glass, scanned meshes.

use super::differences::{Displaced, Part};
use super::error::EngineError;
use super::estimators::Method;
use super::objective::{Evaluation, Objective, check_size, evaluate, inner_product};
use super::prepared::Prepared;
use super::progress::Progress;
use super::render::render;
use super::results::BackwardGradient;
use super::settings::{Groups, Settings};
use super::step_comparison::StepComparison;
use super::steps::Steps;
use super::tails::add_largest_parts;
use crate::gradient::terms::Terms;
use crate::picture::Image;
use crate::scene::parameters::{self, Gradient, Parameter, Target};
use crate::scene::{Rgb, SceneDifferential};
use crate::statistics::estimate::Estimate;

/// Numbers that may be asked for at most. More would take days, and were hardly meant.
const MOST_NUMBERS: usize = 10_000;

/// The derivative of an objective by all numbers of the parameters.
///
/// If it was `auto` that came to this, only what moves geometry or what is refracted is done by
/// differences, and the rest, such as the texels of a picture, along paths in one pass.
pub fn backward(
    prepared: &Prepared,
    settings: &Settings,
    wanted: &[Parameter],
    objective: &Objective,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let (differenced, along_paths) = parted(prepared, settings, wanted)?;
    let numbers: usize = differenced.iter().map(|(_, p)| numbers_of(p)).sum();
    if numbers > MOST_NUMBERS {
        return Err(EngineError::Refused(format!(
            "{} would take one for each of {numbers} numbers; take reparam, which takes one pass for all",
            settings.method.title()
        )));
    }
    let part = |part: usize| Part {
        whole: progress,
        before: part as u64,
        part: 1,
        all: (numbers + 2) as u64,
    };
    let evaluation = evaluate(prepared, settings, objective, &part(0))?;
    let mut done = rest(prepared, settings, &along_paths, &evaluation, &part(1))?;
    if !matches!(objective, Objective::Adjoint(_)) {
        done.loss = evaluation.loss;
        done.image = evaluation.image.unwrap_or(done.image);
    }
    done.statistics.notes.push(format!(
        "{}, one for each of {numbers} numbers",
        settings.method.title()
    ));
    let adjoint = &evaluation.adjoint;
    let settings = &settings.weighted_by(adjoint);
    let displaced = Displaced::new(prepared, settings);
    let mut finished = 2;
    let mut doubt = None;
    for (target, parameter) in differenced {
        let mut of_groups = vec![vec![0.0; parameter.len()]; done.groups.len()];
        for number in 0..numbers_of(&parameter) {
            let mut one = vec![0.0; parameter.len()];
            one[number] = 1.0;
            let direction = [(parameter.clone(), one)];
            let steps = Steps::usual(prepared, settings, &direction)?;
            doubt = doubt.or(steps.doubt());
            let (progress, statistics) = (part(finished), &mut done.statistics);
            let mut compared = StepComparison::default();
            displaced.render(&direction, &steps, &progress, statistics, |it| {
                for (sums, image) in of_groups.iter_mut().zip(&it.groups) {
                    sums[number] += it.weight * weighed(image, &adjoint.pixels);
                }
                compared.add(&it);
            })?;
            let warning = displaced.doubt(compared, (&direction, &steps), &progress)?;
            let warning = warning.map(|why| format!("{}, number {number}: {why}", parameter.key));
            done.statistics.warnings.extend(warning);
            finished += 1;
        }
        let mean = |i| Estimate::mean_of(of_groups.iter().map(|group| group[i])).value as f32;
        let mean = (0..parameter.len()).map(mean).collect();
        done.gradient.numbers.push((target, mean));
        for (gradient, sums) in done.groups.iter_mut().zip(&of_groups) {
            let sums = sums.iter().map(|x| *x as f32).collect();
            gradient.numbers.push((target, sums));
        }
    }
    done.statistics.notes.extend(doubt.map(String::from));
    Ok(done)
}

/// The numbers of a parameter that can change, which come first: the last row of a matrix stays.
pub fn numbers_of(parameter: &Parameter) -> usize {
    match parameter.target {
        Some(Target::ShapeToWorld(_) | Target::SensorToWorld(_)) => 12,
        _ => parameter.len(),
    }
}

/// What a parameter stands for, and itself.
type Moving = (Target, Parameter);

/// What is done by differences, each once, and what along paths.
fn parted(
    prepared: &Prepared,
    settings: &Settings,
    wanted: &[Parameter],
) -> Result<(Vec<Moving>, Vec<Parameter>), EngineError> {
    let scene = prepared.scene;
    let (mut differenced, mut along_paths) = (Vec::new(), Vec::new());
    for parameter in wanted {
        let one = std::slice::from_ref(parameter);
        let request = parameters::wanted(scene, one, settings.sensor)?;
        let moves = request.moves_geometry() || request.refraction_moves(scene);
        match parameter.target {
            Some(target) if moves || !settings.is_decided() => {
                if differenced.iter().all(|(known, _)| *known != target) {
                    differenced.push((target, parameter.clone()));
                }
            }
            _ => along_paths.push(parameter.clone()),
        }
    }
    Ok((differenced, along_paths))
}

/// What needs no differences: the gradient by what moves nothing, and the image, if the objective's
/// has not been rendered.
fn rest(
    prepared: &Prepared,
    settings: &Settings,
    along_paths: &[Parameter],
    evaluation: &Evaluation,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let adjoint = &evaluation.adjoint;
    let mut done = match along_paths.is_empty() {
        true => without_paths(prepared, settings, evaluation, progress)?,
        false => {
            let settings = Settings {
                method: Method::Auto,
                ..settings.clone()
            };
            let request = parameters::wanted(prepared.scene, along_paths, settings.sensor)?;
            let objective = Objective::Adjoint(adjoint);
            let mut done =
                super::backward::backward(prepared, &settings, &request, &objective, progress)?;
            add_largest_parts(&mut done, along_paths);
            done
        }
    };
    done.statistics.absorb(&evaluation.statistics);
    Ok(done)
}

/// No gradient yet.
fn without_paths(
    prepared: &Prepared,
    settings: &Settings,
    evaluation: &Evaluation,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let scene = prepared.scene;
    let own_groups = match settings.groups() {
        Groups { only: Some(_), .. } => 1,
        Groups { count, .. } => count as usize,
    };
    let none = Gradient::from(SceneDifferential::none(scene));
    let mut done = BackwardGradient {
        image: Image::default(),
        loss: 0.0,
        gradient: none.clone(),
        groups: vec![none; own_groups],
        terms: Terms::new(scene.meshes.len(), scene.textures.len()),
        statistics: Default::default(),
    };
    if evaluation.image.is_none() {
        let rendering = render(prepared, settings, progress)?;
        let image = rendering.image;
        check_size(&evaluation.adjoint, [image.width, image.height])?;
        done.loss = inner_product(&image, &evaluation.adjoint);
        done.image = image;
        done.statistics = rendering.statistics;
    }
    Ok(done)
}

fn weighed(image: &[Rgb], adjoint: &[Rgb]) -> f64 {
    let pairs = image.as_flattened().iter().zip(adjoint.as_flattened());
    pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}
