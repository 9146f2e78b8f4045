//! One job's computation: from its line and its scene to results that are ready to be written.

use super::direction;
use super::failure::Failure;
use super::job::{Job, Loss, Mode};
use super::loaded::{Lease, Loaded};
use super::pairs::Keys;
use super::settings;
use crate::methods::{
    Edits, ForwardGradient, Image, Objective, Prepared, Progress, Settings, Statistics, Workers,
    check_meshes,
};
use crate::output::gradients;
use crate::output::results::{self, NotFinite, ResultFile};
use crate::output::tensors::Tensor;
use crate::room::Cancelled;
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter, Target};

/// What a job has computed.
pub enum Results {
    Image(Image),
    Forward(Box<ForwardGradient>),
    Backward {
        gradients: Vec<Tensor>,
        image: Image,
    },
}

/// Results with what is said of them.
pub struct Done {
    pub results: Results,
    pub loss: Option<f64>,
    pub statistics: Statistics,
}

impl Results {
    /// The files of these results.
    pub fn files(&self) -> Result<Vec<ResultFile<'_>>, NotFinite> {
        match self {
            Results::Image(image) => results::rendered(image),
            Results::Forward(done) => results::forward(done),
            Results::Backward { gradients, image } => results::backward(gradients, image),
        }
    }

    /// The norm of each gradient and of its standard error.
    pub fn norms(&self) -> Vec<(String, f64)> {
        let of_image = |image: &Image| gradients::norm(image.pixels.iter().flatten());
        match self {
            Results::Image(_) => Vec::new(),
            Results::Forward(done) => {
                let mut norms = vec![("gradient".to_string(), of_image(&done.gradient))];
                let name = format!("gradient{}", gradients::STANDARD_ERROR);
                norms.extend(
                    done.stderr
                        .iter()
                        .map(|image| (name.clone(), of_image(image))),
                );
                norms
            }
            Results::Backward { gradients, .. } => gradients
                .iter()
                .map(|tensor| (tensor.name.clone(), gradients::norm(&tensor.values)))
                .collect(),
        }
    }
}

/// The scene of a job with its `set` values, ready to be traced.
pub struct Stand<'a> {
    loaded: &'a Loaded,
    /// The scene with the job's values, if it has any.
    changed: Option<Scene>,
    edits: Edits,
    lease: Option<Lease>,
}

impl<'a> Stand<'a> {
    /// Applies the job's values.
    pub fn new(job: &Job, loaded: &'a Loaded, threads: usize) -> Result<Self, Failure> {
        let mut edits = Edits::none(&loaded.scene);
        if job.set.0.is_empty() {
            return Ok(Self {
                loaded,
                changed: None,
                edits,
                lease: None,
            });
        }
        let mut scene = loaded.scene.clone();
        for (key, numbers) in &job.set.0 {
            let parameter = parameters::find(&scene, key)?;
            let values = numbers.exactly(&parameter, key)?;
            parameters::apply(&mut scene, &parameter, &values)?;
            mark(&mut edits, parameter.target);
        }
        let lease = match edits.moved.contains(&true) {
            true => {
                check_meshes(&scene).map_err(|error| Failure::from_engine(error, None))?;
                Some(loaded.follow(&scene, &edits, threads)?)
            }
            false => None,
        };
        Ok(Self {
            loaded,
            changed: Some(scene),
            edits,
            lease,
        })
    }

    /// The scene as the job has it.
    pub fn scene(&self) -> &Scene {
        self.changed.as_ref().unwrap_or(&self.loaded.scene)
    }

    /// Whether its structure was built anew, if vertices have moved.
    pub fn is_rebuilt(&self) -> Option<bool> {
        let lease = self.lease.as_ref()?;
        Some(matches!(lease, Lease::Rebuilt(_)))
    }

    /// Makes what the job's values have changed, and shares the rest.
    pub fn prepare(
        &self,
        workers: &Workers,
        cancelled: Cancelled,
    ) -> Result<Prepared<'_>, Failure> {
        let shared = &self.loaded.parts;
        let parts = match &self.changed {
            None => shared.clone(),
            Some(scene) => {
                let lease = self.lease.as_ref();
                let accel = lease.map_or(shared.accel(), Lease::accel);
                shared
                    .edited(scene, &self.edits, accel.clone(), workers, cancelled)
                    .map_err(|error| Failure::from_engine(error, None))?
            }
        };
        Ok(Prepared {
            scene: self.scene(),
            parts,
            workers: workers.clone(),
            build_seconds: 0.0,
        })
    }

    /// Gives back what the next job can use.
    pub fn finish(self) {
        if let Some(lease) = self.lease {
            self.loaded.give_back(lease);
        }
    }
}

fn mark(edits: &mut Edits, target: Option<Target>) {
    match target {
        Some(
            Target::VertexPositions(mesh)
            | Target::ShapeTranslation(mesh)
            | Target::ShapeRotation(mesh)
            | Target::ShapeScale(mesh),
        ) => edits.moved[mesh] = true,
        Some(Target::Texels(texture) | Target::Texel { texture, .. } | Target::ToUv(texture)) => {
            edits.textures[texture] = true
        }
        Some(Target::EnvironmentScale | Target::EnvironmentRotation) => edits.environment = true,
        // Cameras and lights without an extent are read from the scene itself.
        Some(
            Target::SensorTranslation(_)
            | Target::SensorRotation(_)
            | Target::SensorXFov(_)
            | Target::DeltaLightPosition(_)
            | Target::DeltaLightTranslation(_),
        )
        | None => {}
    }
}

/// What a job asks of its scene, files read and keys found.
pub enum Question {
    Render,
    Forward(direction::Direction),
    Backward {
        parameters: Vec<Parameter>,
        image: Image,
        /// None for an adjoint.
        loss: Option<Loss>,
    },
}

impl Question {
    /// Finds the job's parameters in its scene, and reads its pictures.
    pub fn new(job: &Job, scene: &Scene, settings: &Settings) -> Result<Self, Failure> {
        let keys = job.params.as_ref();
        match (job.mode, keys) {
            (Mode::Forward, Some(Keys::Tangents(tangents))) => Ok(Question::Forward(
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
                Ok(Question::Backward {
                    parameters,
                    image: settings::image(file, settings::size(settings, scene))?,
                    loss: job.target.is_some().then(|| job.loss.unwrap_or_default()),
                })
            }
            _ => Ok(Question::Render),
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
            Question::Render => {
                let done = prepared.render(settings, progress).map_err(failed)?;
                Ok(Done {
                    results: Results::Image(done.image),
                    loss: None,
                    statistics: done.statistics,
                })
            }
            Question::Forward(direction) => {
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
            Question::Backward {
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
