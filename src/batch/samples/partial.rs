//! A part of a job's samples: some of its groups, kept apart so that they can be added up in their
//! order, whoever has done them.

use super::share::{image_tensor, of_group};
use crate::batch::queue::shard::Shard;
use crate::batch::results::line::Share;
use crate::jobs::failure::Failure;
use crate::jobs::job::Job;
use crate::jobs::request::{Request, objective};
use crate::jobs::results::Results;
use crate::methods::{
    Evaluation, Groups, Image, Objective, Prepared, Progress, Settings, Statistics, equal_groups,
};
use crate::output::tensors::Tensor;

/// Groups of a job that is shared out, at least: as many processes can share it.
const LEAST_GROUPS: u32 = 16;

/// A share's numbers.
pub struct Partial {
    pub share: Share,
    pub tensors: Vec<Tensor>,
    /// Of a target; that of an adjoint is known when all groups are.
    pub loss: Option<f64>,
    pub statistics: Statistics,
}

fn group_count(settings: &Settings) -> u32 {
    match settings.groups {
        Some(groups) => groups.count,
        None => equal_groups(settings.spp, LEAST_GROUPS),
    }
}

/// The groups that `shard` does.
pub fn own_groups(settings: &Settings, shard: Shard) -> Vec<u32> {
    let all = 0..group_count(settings);
    all.filter(|&group| shard.has(group as usize)).collect()
}

/// Does the groups of `shard`.
pub fn answer(
    job: &Job,
    request: &Request,
    shard: Shard,
    prepared: &Prepared,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Partial, Failure> {
    if !settings.method.shares_samples() {
        return Err(Failure::Input(format!(
            "method: {} cannot be shared out by samples; use --split jobs",
            settings.method.title()
        )));
    }
    let count = group_count(settings);
    let done = own_groups(settings, shard);
    let mut partial = Partial {
        share: Share {
            mode: job.mode,
            groups: count,
            keys: match request {
                Request::Backward { parameters, .. } => {
                    parameters.iter().map(|p| p.key.clone()).collect()
                }
                _ => Vec::new(),
            },
            stderr: settings.standard_error,
            outputs: job.outputs.clone(),
            done,
        },
        tensors: Vec::new(),
        loss: None,
        statistics: Statistics::default(),
    };
    if partial.share.done.is_empty() {
        return Ok(partial);
    }
    let evaluated = partial.evaluate(request, prepared, settings, progress)?;
    for group in partial.share.done.clone() {
        let settings = Settings {
            groups: Some(Groups {
                count,
                only: Some(group),
            }),
            ..settings.clone()
        };
        let done = match (&evaluated, request) {
            (Some(evaluated), Request::Backward { parameters, .. }) => {
                // The derivative by the image is the same in all groups.
                let given = Request::Backward {
                    parameters: parameters.clone(),
                    image: evaluated.adjoint.clone(),
                    loss: None,
                };
                given.answer(prepared, &settings, progress)?
            }
            _ => request.answer(prepared, &settings, progress)?,
        };
        partial.statistics.absorb(&done.statistics);
        let has_image = evaluated.as_ref().is_some_and(|e| e.image.is_some());
        partial.keep(group, done.results, has_image);
    }
    Ok(partial)
}

impl Partial {
    /// Of a backward job, the derivative by the image; keeps what only the whole job has, once.
    fn evaluate(
        &mut self,
        request: &Request,
        prepared: &Prepared,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Option<Evaluation>, Failure> {
        let Request::Backward { image, loss, .. } = request else {
            return Ok(None);
        };
        let objective: Objective = objective(image, *loss);
        let evaluated = prepared
            .evaluate(settings, &objective, progress)
            .map_err(|error| Failure::from_engine(error, None))?;
        self.statistics.absorb(&evaluated.statistics);
        let is_first = self.share.done.contains(&0);
        match &evaluated.image {
            Some(image) => {
                self.loss = Some(evaluated.loss);
                if is_first {
                    self.tensors.push(image_tensor("image".into(), image));
                }
            }
            None if is_first => {
                let adjoint = image_tensor("adjoint".into(), &evaluated.adjoint);
                self.tensors.push(adjoint);
            }
            None => {}
        }
        Ok(Some(evaluated))
    }

    /// Keeps a group's results.
    fn keep(&mut self, group: u32, results: Results, has_image: bool) {
        let mut image = |name: &str, image: &Image| {
            let tensor = image_tensor(of_group(name, group), image);
            self.tensors.push(tensor);
        };
        match results {
            Results::Image(rendered) => image("image", &rendered),
            Results::Forward(done) => {
                image("image", &done.image);
                image("gradient", &done.gradient);
            }
            Results::Backward {
                gradients,
                image: own,
            } => {
                if !has_image {
                    image("image", &own);
                }
                // A single group has no standard errors.
                self.tensors
                    .extend(gradients.into_iter().map(|tensor| Tensor {
                        name: of_group(&tensor.name, group),
                        ..tensor
                    }));
            }
        }
    }
}
