//! What a job asks of its scene, files read and keys found, and the answer.

use super::direction;
use super::failure::Failure;
use super::job::Job;
use super::mode::{Loss, Mode};
use super::pairs::Keys;
use super::pictures;
use super::results::{Done, Results};
use super::settings;
use crate::methods::{Objective, Prepared, Progress, Question, Settings};
use crate::output::gradients;
use crate::picture::Image;
use crate::scene::Scene;
use crate::scene::parameters::Parameter;

/// What a job asks of its scene, files read and keys found.
pub enum Request {
    Render,
    Forward(direction::Direction),
    Backward {
        parameters: Vec<Parameter>,
        image: Image,
        /// None for an adjoint.
        loss: Option<Loss>,
    },
}

impl Request {
    /// Finds the job's parameters in its scene, and reads its pictures.
    pub fn new(job: &Job, scene: &Scene, settings: &Settings) -> Result<Self, Failure> {
        let keys = job.params.as_ref();
        match (job.mode, keys) {
            (Mode::Forward, Some(Keys::Tangents(tangents))) => Ok(Request::Forward(
                direction::resolve(scene, &tangents.0, settings.sensor)?,
            )),
            (Mode::Backward, Some(Keys::Names(names))) => {
                let keys: Vec<&str> = names.iter().map(String::as_str).collect();
                let parameters = direction::find(scene, &keys, settings.sensor)?;
                let Some(file) = job.adjoint.as_ref().or(job.target.as_ref()) else {
                    return Err(Failure::Input(
                        "backward needs an adjoint or a target".into(),
                    ));
                };
                Ok(Request::Backward {
                    parameters,
                    image: pictures::image(file, settings::size(settings, scene))?,
                    loss: job.target.is_some().then(|| job.loss.unwrap_or_default()),
                })
            }
            _ => Ok(Request::Render),
        }
    }

    /// What a pilot would be asked.
    pub fn question(&self) -> Option<Question<'_>> {
        match self {
            Request::Render => None,
            Request::Forward(direction) => Some(Question::Forward(direction)),
            Request::Backward { parameters, .. } => Some(Question::Backward(parameters)),
        }
    }

    /// Computes the answer.
    pub fn answer(
        &self,
        prepared: &Prepared,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Done, Failure> {
        let failed = |error| Failure::from_engine(error, None);
        match self {
            Request::Render => {
                let done = prepared.render(settings, progress).map_err(failed)?;
                Ok(Done {
                    results: Results::Image(done.image),
                    loss: None,
                    statistics: done.statistics,
                })
            }
            Request::Forward(direction) => {
                let mut done = prepared
                    .forward(settings, direction, progress)
                    .map_err(failed)?;
                done.stderr = done.stderr.filter(|_| settings.standard_error);
                let statistics = std::mem::take(&mut done.statistics);
                Ok(Done {
                    results: Results::Forward(Box::new(done)),
                    loss: None,
                    statistics,
                })
            }
            Request::Backward {
                parameters,
                image,
                loss,
            } => {
                let done = prepared
                    .backward(settings, parameters, &objective(image, *loss), progress)
                    .map_err(failed)?;
                let of = |parameter: &Parameter| {
                    let groups = gradients::reduced(prepared.scene, parameter, &done.groups);
                    let (key, shape) = (&parameter.key, &parameter.shape);
                    gradients::of_groups(key, shape, &groups, settings.standard_error)
                };
                Ok(Done {
                    results: Results::Backward {
                        gradients: parameters.iter().flat_map(of).collect(),
                        image: done.image,
                    },
                    loss: Some(done.loss),
                    statistics: done.statistics,
                })
            }
        }
    }
}

/// What the gradient is taken of.
pub fn objective(image: &Image, loss: Option<Loss>) -> Objective<'_> {
    match loss {
        None => Objective::Adjoint(image),
        Some(Loss::L1) => Objective::L1(image),
        Some(Loss::L2) => Objective::L2(image),
    }
}
