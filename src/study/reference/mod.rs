//! What methods are compared with: finite differences at several steps, which must agree.

mod cache;
mod ladder;
mod rungs;

pub use ladder::{Ladder, between};

use super::config::ReferencePlan;
use super::task::Task;
use crate::jobs::failure::Failure;
use crate::jobs::seeds::{FIRST_REFERENCE_SEED, nth_seed};
use crate::methods::{self, Method, Progress, Settings};
use crate::statistics::comparison::PICTURE_ROUNDING;
use crate::statistics::estimate::Estimate;
use rungs::Rungs;
use std::path::Path;

/// Below this part of the mean's square, what stands out of the noise is taken for noise.
const LEAST_SIGNAL: f64 = 0.1;

/// Finite differences of one direction, and how sure they are.
pub struct Reference {
    /// Each run's image, as the steps that agree give it together.
    pub runs: Vec<Vec<f64>>,
    pub mean: Vec<f64>,
    /// Standard errors of `mean`.
    pub error: Vec<f64>,
    /// Root mean square of the gradient, freed of noise; none if it does not stand out of it.
    pub rms: Option<f64>,
    /// What rounding may leave in a number.
    pub rounding: f64,
    pub ladder: Ladder,
}

/// Finite differences from the cache, or made now and put there. `done` counts camera paths.
pub fn obtain(
    task: &Task,
    folder: &Path,
    progress: &dyn Progress,
    done: &mut dyn FnMut(u64),
) -> Result<Reference, Failure> {
    let plan = &task.plan.effort.reference;
    let shape = [plan.steps.len(), plan.runs, task.numbers()];
    let rungs = match cache::read(folder, task.reference_key, shape) {
        Some(rungs) => {
            done(paths(task));
            rungs
        }
        None => {
            let rungs = compute(task, plan, progress, done)?;
            cache::write(folder, task.reference_key, shape, &rungs)?;
            rungs
        }
    };
    Ok(Reference::of(&rungs, plan, task.step))
}

/// Camera paths that making it takes.
pub fn paths(task: &Task) -> u64 {
    let plan = &task.plan.effort.reference;
    let runs = plan.runs * plan.steps.len() * methods::DIFFERENCE_IMAGES;
    task.paths(plan.spp) * runs as u64
}

fn compute(
    task: &Task,
    plan: &ReferencePlan,
    progress: &dyn Progress,
    done: &mut dyn FnMut(u64),
) -> Result<Rungs, Failure> {
    let mut brightest: f64 = 0.0;
    let mut steps = Vec::new();
    for (rung, part) in plan.steps.iter().enumerate() {
        let mut runs = Vec::new();
        for run in 0..plan.runs {
            let settings = Settings {
                method: Method::REFERENCE,
                spp: plan.spp,
                seed: nth_seed(
                    task.settings.seed,
                    FIRST_REFERENCE_SEED + rung * plan.runs + run,
                ),
                standard_error: false,
                ..task.settings.clone()
            };
            let step = part * task.step;
            let made = methods::difference(task.scene, &settings, &task.direction, step, progress);
            let made = made.map_err(|error| Failure::from_engine(error, None))?;
            let numbers = made.image.pixels.iter().flatten();
            brightest = numbers.fold(brightest, |most, v| most.max(f64::from(v.abs())));
            runs.push(made.gradient.pixels.into_flattened());
            done(task.paths(plan.spp) * methods::DIFFERENCE_IMAGES as u64);
        }
        steps.push(runs);
    }
    Ok(Rungs { steps, brightest })
}

impl Reference {
    fn of(rungs: &Rungs, plan: &ReferencePlan, step: f64) -> Self {
        let exact = |runs: &Vec<Vec<f32>>| -> Vec<Vec<f64>> {
            let run = |run: &Vec<f32>| run.iter().map(|x| f64::from(*x)).collect();
            runs.iter().map(run).collect()
        };
        let steps: Vec<_> = rungs.steps.iter().map(exact).collect();
        let rounding_at = |part: f64| PICTURE_ROUNDING * rungs.brightest / (part * step);
        let (ladder, runs) = Ladder::climb(&steps, &plan.steps, rounding_at);
        let estimates: Vec<Estimate> = (0..runs[0].len())
            .map(|i| Estimate::mean_of(runs.iter().map(|run| run[i])))
            .collect();
        let n = estimates.len() as f64;
        let square: f64 = estimates.iter().map(|e| e.value * e.value).sum::<f64>() / n;
        let noise: f64 = estimates.iter().map(|e| e.error * e.error).sum::<f64>() / n;
        let rounding = rounding_at(ladder.used[1]);
        let stands_out = square - noise > LEAST_SIGNAL * square && square.sqrt() > rounding;
        Self {
            rms: stands_out.then(|| (square - noise).sqrt()),
            mean: estimates.iter().map(|e| e.value).collect(),
            error: estimates.iter().map(|e| e.error).collect(),
            runs,
            rounding,
            ladder,
        }
    }

    /// Root mean square of the standard errors.
    pub fn noise(&self) -> f64 {
        let squares: f64 = self.error.iter().map(|e| e * e).sum();
        (squares / self.error.len() as f64).sqrt()
    }

    /// What figures are relative to: the gradient's size, or 1 where there is none.
    pub fn unit(&self) -> f64 {
        self.rms.unwrap_or(1.0)
    }
}
