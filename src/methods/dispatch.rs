//! From what is asked for to the method that computes it.

use super::differences;
use super::error::EngineError;
use super::estimators::MakeBoundary;
use super::forward::forward_and_foretell;
use super::number_by_number;
use super::objective::{self, Evaluation, Objective};
use super::pilot::Question;
use super::prepared::Prepared;
use super::progress::Progress;
use super::render::Along;
use super::results::{BackwardGradient, ForwardGradient, Rendering};
use super::settings::Settings;
use super::statistics::{Pilot, Statistics};
use super::steps::Steps;
use super::tails::add_largest_parts;
use crate::picture::Image;
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter};

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
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    let mut done = prepared.forward(settings, direction, progress)?;
    done.statistics.spend("build", prepared.build_seconds);
    Ok(done)
}

/// The settings with which `auto` answers a question, and the pilot behind them.
pub fn decide(
    scene: &Scene,
    settings: &Settings,
    question: &Question,
    progress: &dyn Progress,
) -> Result<(Settings, Pilot), EngineError> {
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    prepared.decide(settings, question, progress)
}

/// The same by finite differences with a step of one's own.
pub fn difference(
    scene: &Scene,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    step: f64,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    differences::forward_by_step(&prepared, settings, direction, step, progress)
}

/// The variance that those have of what jumps, over all numbers of the gradient image, foretold
/// from borders that a look at the scene finds.
pub fn foretell_difference(
    scene: &Scene,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    step: f64,
    progress: &dyn Progress,
) -> Result<f64, EngineError> {
    let prepared = Prepared::new(scene, settings, &|| progress.cancelled())?;
    let tangent = parameters::tangent(scene, direction, settings.sensor)?;
    let (boundary, steps) = (settings.method.boundary(), Steps::at_rest(step));
    let done = forward_and_foretell(
        &prepared,
        settings,
        &tangent,
        boundary,
        Some(&steps),
        progress,
    )?;
    Ok(done.1)
}

/// Reverse mode: the derivative of an objective with respect to all the parameters, in one pass or
/// by a difference for each number.
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

impl Prepared<'_> {
    /// Renders the image.
    pub fn render(
        &self,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Rendering, EngineError> {
        super::render::render(self, settings, progress)
    }

    /// Renders the images of the groups of samples that the settings ask for, each independent of
    /// the others.
    pub fn group_images(
        &self,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<(Vec<Image>, Statistics), EngineError> {
        let mut statistics = Statistics::default();
        let (groups, [width, height]) = super::render::group_images(
            self,
            settings,
            Along::default(),
            progress,
            &mut statistics,
        )?;
        let image = |pixels| Image {
            width,
            height,
            pixels,
        };
        Ok((groups.into_iter().map(image).collect(), statistics))
    }

    /// Forward mode: the derivative of the image along one direction in parameter space.
    pub fn forward(
        &self,
        settings: &Settings,
        direction: &[(Parameter, Vec<f32>)],
        progress: &dyn Progress,
    ) -> Result<ForwardGradient, EngineError> {
        if settings.needs_pilot() {
            let question = Question::Forward(direction);
            let (settled, pilot) = self.decide(settings, &question, progress)?;
            let mut done = self.forward(&settled, direction, progress)?;
            done.statistics.add_pilot(pilot);
            return Ok(done);
        }
        if settings.method.displaces_scenes() {
            return differences::forward(self, settings, direction, progress);
        }
        self.forward_by(settings, direction, settings.method.boundary(), progress)
    }

    /// The same by stored paths, with the boundary terms that an estimator of one's own finds.
    pub fn forward_by(
        &self,
        settings: &Settings,
        direction: &[(Parameter, Vec<f32>)],
        boundary: Option<MakeBoundary>,
        progress: &dyn Progress,
    ) -> Result<ForwardGradient, EngineError> {
        let tangent = parameters::tangent(self.scene, direction, settings.sensor)?;
        super::forward::forward(self, settings, &tangent, boundary, progress)
    }

    /// The value of an objective and its derivative by the image.
    pub fn evaluate(
        &self,
        settings: &Settings,
        objective: &Objective,
        progress: &dyn Progress,
    ) -> Result<Evaluation, EngineError> {
        objective::evaluate(self, settings, objective, progress)
    }

    /// Reverse mode: the derivative of an objective with respect to all the parameters, in one pass
    /// or by a difference for each number.
    pub fn backward(
        &self,
        settings: &Settings,
        wanted: &[Parameter],
        objective: &Objective,
        progress: &dyn Progress,
    ) -> Result<BackwardGradient, EngineError> {
        if settings.needs_pilot() {
            let question = Question::Backward(wanted);
            let (settled, pilot) = self.decide(settings, &question, progress)?;
            let mut done = self.backward(&settled, wanted, objective, progress)?;
            done.statistics.add_pilot(pilot);
            return Ok(done);
        }
        if settings.method.displaces_scenes() {
            return number_by_number::backward(self, settings, wanted, objective, progress);
        }
        let request = parameters::wanted(self.scene, wanted, settings.sensor)?;
        let mut done = super::backward::backward(self, settings, &request, objective, progress)?;
        add_largest_parts(&mut done, wanted);
        Ok(done)
    }
}
