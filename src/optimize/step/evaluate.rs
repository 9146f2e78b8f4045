//! The loss of some views at some values, its gradient, and the noise of both.
//!
//! The image in the loss and the derivative have independent samples: E[f′(I)·∂I] is E[f′(I)]·∂I
//! then, which for a loss with a linear derivative is the gradient itself.

use super::found::{Evaluation, Look, Sampling};
use super::ranks::Ranks;
use super::total_variation;
use super::unit::{Units, failed, is_of_silhouette};
use crate::jobs::failure::Failure;
use crate::methods::{EditedScene, Progress, Statistics};
use crate::optimize::loss::{Comparison, estimate};
use crate::optimize::problem::Problem;
use crate::optimize::problem::base::SceneBase;
use crate::picture::Image;
use std::time::Instant;

/// Measures the loss of `looks` and differentiates it.
pub fn evaluate(
    problem: &Problem,
    values: &[Vec<f32>],
    looks: &[Look],
    sampling: &Sampling,
    ranks: &dyn Ranks,
    progress: &dyn Progress,
) -> Result<Evaluation, Failure> {
    let start = Instant::now();
    let scene = edited(problem, &problem.base, values, false)?;
    let silhouette = match &problem.silhouette {
        Some(base) if looks.iter().any(|look| look.silhouette) => {
            Some((base, edited(problem, base, values, true)?))
        }
        _ => None,
    };
    let workers = &problem.machine.workers;
    let cancelled = || progress.cancelled();
    let prepared = scene.prepare(workers, &cancelled).map_err(failed)?;
    let covered = match &silhouette {
        Some((_, edited)) => Some(edited.prepare(workers, &cancelled).map_err(failed)?),
        None => None,
    };
    let mut done = Evaluation::default();
    done.statistics.add_seconds("refit", start);
    let units = Units {
        problem,
        sampling,
        values,
        scene: &prepared,
        silhouette: covered.as_ref(),
        progress,
    };
    let adjoints = measure(&units, looks, ranks, &mut done)?;
    differentiate(&units, looks, &adjoints, ranks, &mut done)?;
    total_variation::add(problem, values, &mut done);
    drop(prepared);
    drop(covered);
    problem.base.give_back(scene.finish());
    if let Some((base, edited)) = silhouette {
        base.give_back(edited.finish());
    }
    Ok(done)
}

/// A base with the values that mean something in it.
fn edited<'a>(
    problem: &Problem,
    base: &'a SceneBase,
    values: &[Vec<f32>],
    silhouette: bool,
) -> Result<EditedScene<'a>, Failure> {
    let counts = |i: &usize| !silhouette || is_of_silhouette(&problem.variables[*i].parameter);
    let which: Vec<usize> = (0..values.len()).filter(counts).collect();
    base.with(&problem.variables, values, &which, problem.machine.threads)
}

/// How a look is compared, and how much it counts: views equally, what they cover by its weight.
fn comparison(problem: &Problem, look: &Look, step: u64) -> (Comparison, f64) {
    let view = &problem.views[look.view];
    match (look.silhouette, &problem.config.loss.silhouette) {
        (true, Some(silhouette)) => (problem.coverage(view, step), silhouette.weight),
        _ => (problem.comparison(view, step), 1.0),
    }
}

/// The losses, and the derivative of their sum by each image.
fn measure(
    units: &Units,
    looks: &[Look],
    ranks: &dyn Ranks,
    done: &mut Evaluation,
) -> Result<Vec<Image>, Failure> {
    let problem = units.problem;
    let shares = problem.config.render.shares as usize;
    let mut spent = Statistics::default();
    let found = ranks.map(looks.len() * shares, &mut |unit| {
        units.images(&looks[unit / shares], (unit % shares) as u32, &mut spent)
    })?;
    done.statistics.absorb(&spent);
    let start = Instant::now();
    let views = looks.iter().filter(|look| !look.silhouette).count().max(1) as f64;
    let mut adjoints = Vec::new();
    let mut squares = Some(0.0);
    let mut floor = Some(0.0);
    for (number, look) in looks.iter().enumerate() {
        let (comparison, weight) = comparison(problem, look, units.sampling.step);
        let groups = images(
            &found[number * shares..(number + 1) * shares],
            comparison.target(),
        );
        let (loss, mean, mut adjoint) = estimate(&comparison, &groups);
        let scale = weight / views;
        done.loss.value += scale * loss.value;
        squares = squares
            .zip(loss.error)
            .map(|(sum, error)| sum + (scale * error).powi(2));
        floor = floor
            .zip(loss.floor)
            .map(|(sum, floor)| sum + scale * floor);
        for slope in adjoint.pixels.iter_mut().flatten() {
            *slope = (f64::from(*slope) * scale) as f32;
        }
        adjoints.push(adjoint);
        if !look.silhouette {
            done.images.push((look.view, mean));
        }
    }
    done.loss.error = squares.map(f64::sqrt);
    done.loss.floor = floor;
    done.statistics.add_seconds("compare", start);
    Ok(adjoints)
}

/// The groups' images of all shares.
fn images(shares: &[Vec<f32>], like: &Image) -> Vec<Image> {
    let (width, height) = (like.width, like.height);
    let groups = shares
        .iter()
        .flat_map(|all| all.chunks_exact(3 * width * height));
    groups
        .map(|numbers| Image {
            width,
            height,
            pixels: numbers.as_chunks::<3>().0.to_vec(),
        })
        .collect()
}

/// Gradients and their variances, added up over looks in order.
fn differentiate(
    units: &Units,
    looks: &[Look],
    adjoints: &[Image],
    ranks: &dyn Ranks,
    done: &mut Evaluation,
) -> Result<(), Failure> {
    let problem = units.problem;
    let shares = problem.config.render.shares as usize;
    let lengths: Vec<usize> = problem
        .variables
        .iter()
        .map(|v| v.parameter.len())
        .collect();
    let numbers: usize = lengths.iter().sum();
    let mut spent = Statistics::default();
    let found = ranks.map(looks.len() * shares, &mut |unit| {
        let (look, share) = (unit / shares, (unit % shares) as u32);
        units.gradients(&looks[look], share, &adjoints[look], &mut spent)
    })?;
    done.statistics.absorb(&spent);
    let (mut sum, mut variance) = (vec![0.0; numbers], vec![0.0; numbers]);
    for look in 0..looks.len() {
        let parts = &found[look * shares..(look + 1) * shares];
        let groups: Vec<&[f32]> = parts
            .iter()
            .flat_map(|all| all.chunks_exact(numbers))
            .collect();
        let count = groups.len() as f64;
        for i in 0..numbers {
            let mean = groups.iter().map(|g| f64::from(g[i])).sum::<f64>() / count;
            let squares: f64 = groups
                .iter()
                .map(|g| (f64::from(g[i]) - mean).powi(2))
                .sum();
            sum[i] += mean;
            if count > 1.0 {
                variance[i] += squares / (count - 1.0) / count;
            }
        }
    }
    let mut at = 0;
    for length in lengths {
        done.gradients.push(sum[at..at + length].to_vec());
        done.variances.push(variance[at..at + length].to_vec());
        at += length;
    }
    Ok(())
}
