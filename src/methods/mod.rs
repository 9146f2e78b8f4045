//! The estimators behind `--method`, and the one interface through which commands use them.

mod backward;
mod differences;
mod forward;
mod groups;
mod prepared;
mod refusals;
mod render;
mod spare;
mod stage;
mod tails;

pub use differences::{IMAGES as DIFFERENCE_IMAGES, step as difference_step};

use crate::gradient::terms::Terms;
use crate::room::{NoRoom, Unfinished};
use crate::scene::parameters::Parameter;
use crate::scene::{Scene, SceneDifferential, SceneError};
use crate::trace::Backend;
use std::collections::BTreeMap;

/// Which estimator computes a gradient.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Differentiates the integrand only and ignores visibility: the wrong answer everyone starts from.
    Interior,
    /// Changes of variables that hold the discontinuities still (Loubet et al. 2019).
    #[default]
    Reparam,
    /// Central finite differences with common random numbers: the reference.
    Fd,
}

impl Method {
    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Method::Interior => "interior",
            Method::Reparam => "reparam",
            Method::Fd => "fd",
        }
    }
}

/// What to render with, the scene's own settings already filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Camera paths per pixel.
    pub spp: u32,
    pub seed: u64,
    pub threads: usize,
    /// Longest path in segments; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// First segment at which russian roulette may end a path.
    pub rr_depth: u32,
    /// Emitters seen directly by the camera are black.
    pub hide_emitters: bool,
    /// Index into [`Scene::sensors`].
    pub sensor: usize,
    /// Width and height in pixels in place of the film's.
    pub resolution: Option<[u32; 2]>,
    pub method: Method,
    /// What traces the rays.
    pub backend: Backend,
    /// Whether to estimate standard errors, which costs memory.
    pub standard_error: bool,
    /// In place of the groups that standard errors need.
    pub groups: Option<Groups>,
}

/// How the samples are parted into independent groups, each with a lattice and random numbers of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Groups {
    /// Divides the number of samples a pixel.
    pub count: u32,
    /// The one group to do, if not all are: the others are done elsewhere.
    pub only: Option<u32>,
}

/// A linear RGB image, row by row from the top left.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Image {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<[f32; 3]>,
}

/// What a run did and where its time went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Rays traced, by kind: camera, shadow, bounce, …
    pub rays: BTreeMap<&'static str, u64>,
    /// Cells between whose ends a silhouette was found.
    pub silhouettes: u64,
    /// Samples rejected, by cause.
    pub rejected: BTreeMap<&'static str, u64>,
    /// Seconds, by stage.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What the threads spent in tiles, added up over threads: the computation without what surrounds it.
    pub tile_seconds: f64,
    /// The share that the largest part has in a gradient, by key: of `backward` that of one packet of paths or one border on
    /// the film in the sum of their squares, of a gradient image (under `gradient`) that of one pixel in a thousand in the
    /// variance.
    pub largest_parts: BTreeMap<String, f64>,
    /// Remarks for the user.
    pub notes: Vec<String>,
}

/// How the engine says how far it is, and learns that it should stop.
pub trait Progress: Sync {
    /// `done` of `total` units of work are finished.
    fn advance(&self, done: u64, total: u64);
    /// Whether the user wants it to stop.
    fn cancelled(&self) -> bool;
}

/// What [`render`] gives.
#[derive(Clone, Debug, Default)]
pub struct Rendering {
    pub image: Image,
    pub statistics: Statistics,
}

/// What [`forward`] gives.
#[derive(Clone, Debug, Default)]
pub struct ForwardGradient {
    pub image: Image,
    /// The derivative of every pixel along the direction.
    pub gradient: Image,
    /// The standard error of every number of `gradient`.
    pub stderr: Option<Image>,
    pub statistics: Statistics,
}

/// What [`backward`] gives.
#[derive(Debug)]
pub struct BackwardGradient {
    pub image: Image,
    pub gradient: SceneDifferential,
    /// Independent estimates of the gradient, whose mean is `gradient`.
    pub groups: Vec<SceneDifferential>,
    pub loss: f64,
    /// Whether few samples carry it.
    pub terms: Terms,
    pub statistics: Statistics,
}

/// The function of the image whose gradient [`backward`] computes.
#[derive(Clone, Copy, Debug)]
pub enum Objective<'a> {
    /// The sum over pixels and channels of image times this.
    Adjoint(&'a Image),
    /// The mean over pixels and channels of |image − target|.
    L1(&'a Image),
    /// The mean over pixels and channels of (image − target)².
    L2(&'a Image),
}

/// Why the engine gave nothing.
#[derive(Clone, Debug, thiserror::Error)]
pub enum EngineError {
    /// The scene, parameter or setting cannot be served.
    #[error("{0}")]
    Refused(String),
    /// [`Progress::cancelled`] said so.
    #[error("interrupted")]
    Interrupted,
    /// The machine could not.
    #[error("{0}")]
    Failed(String),
}

/// An objective at the present parameters.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Its value; 0 for [`Objective::Adjoint`], whose value is known after its backward pass.
    pub loss: f64,
    /// Its derivative by the image.
    pub adjoint: Image,
    /// The image it was measured on, if one had to be rendered for that.
    pub image: Option<Image>,
    pub statistics: Statistics,
}

pub use backward::inner_product;
pub use groups::{GroupMean, equal_groups, group_count};
pub use prepared::{Edits, Parts, Prepared, Workers, views};
pub use refusals::check_meshes;
pub use tails::MOST as MOST_OF_ONE_PART;

impl From<SceneError> for EngineError {
    fn from(error: SceneError) -> Self {
        EngineError::Refused(error.to_string())
    }
}

impl From<NoRoom> for EngineError {
    fn from(error: NoRoom) -> Self {
        EngineError::Failed(error.to_string())
    }
}

impl From<Unfinished> for EngineError {
    fn from(error: Unfinished) -> Self {
        match error {
            Unfinished::NoRoom(error) => error.into(),
            Unfinished::Interrupted => EngineError::Interrupted,
        }
    }
}

/// Renders the image.
pub fn render(
    scene: &Scene,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Rendering, EngineError> {
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    let mut done = prepared.render(settings, progress)?;
    done.statistics.spend("build", prepared.build_seconds);
    Ok(done)
}

/// Forward mode: the derivative of the image along one direction in parameter space.
pub fn forward(
    scene: &Scene,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    if settings.method == Method::Fd {
        // Every image is of another scene: this one need not be prepared.
        let workers = Workers::new(settings.threads)?;
        return differences::forward(scene, &workers, settings, direction, progress);
    }
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    let mut done = prepared.forward(settings, direction, progress)?;
    done.statistics.spend("build", prepared.build_seconds);
    Ok(done)
}

/// Reverse mode: the derivative of an objective with respect to all the parameters, in one pass.
pub fn backward(
    scene: &Scene,
    settings: &Settings,
    wanted: &[Parameter],
    objective: &Objective,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    let mut done = prepared.backward(settings, wanted, objective, progress)?;
    done.statistics.spend("build", prepared.build_seconds);
    Ok(done)
}
