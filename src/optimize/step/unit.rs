//! Units of work: one share of one look's samples.

use super::found::{Look, Sampling};
use crate::jobs::failure::Failure;
use crate::methods::{
    EngineError, Groups, Objective, Prepared, Progress, Settings, Statistics, group_count,
};
use crate::optimize::problem::{Problem, pose, seeds};
use crate::picture::Image;
use crate::scene::parameters::{Parameter, Target};

/// What units of one step share.
pub struct Units<'a> {
    pub problem: &'a Problem,
    pub sampling: &'a Sampling,
    pub values: &'a [Vec<f32>],
    /// The scene with these values, and that of the mask term.
    pub scene: &'a Prepared<'a>,
    pub silhouette: Option<&'a Prepared<'a>>,
    pub progress: &'a dyn Progress,
}

impl Units<'_> {
    fn prepared(&self, look: &Look) -> Result<&Prepared<'_>, Failure> {
        match (look.silhouette, self.silhouette) {
            (false, _) => Ok(self.scene),
            (true, Some(prepared)) => Ok(prepared),
            (true, None) => Err(Failure::System("the mask term has no scene".into())),
        }
    }

    fn settings(&self, look: &Look, share: u32, spp: u32, purpose: u64) -> Settings {
        let shares = self.problem.config.render.shares;
        let view = &self.problem.views[look.view];
        let mut settings = self.problem.settings_of(view, self.sampling.step);
        if look.silhouette {
            settings.max_depth = 1;
            settings.hide_emitters = false;
        }
        settings.spp = spp;
        let what = purpose + 16 * u64::from(look.silhouette);
        let seed = self.problem.config.seed;
        settings.seed = seeds::of(seed, [what, self.sampling.step, look.view as u64]);
        settings.groups = Some(match shares {
            1 => Groups {
                count: group_count(spp),
                only: None,
            },
            count => Groups {
                count,
                only: Some(share),
            },
        });
        settings
    }

    /// The pixels of each group's image, one after another.
    pub fn images(
        &self,
        look: &Look,
        share: u32,
        statistics: &mut Statistics,
    ) -> Result<Vec<f32>, Failure> {
        let settings = self.settings(look, share, self.sampling.loss_spp, seeds::LOSS);
        let (images, spent) = self
            .prepared(look)?
            .group_images(&settings, self.progress)
            .map_err(failed)?;
        let seconds: f64 = spent.seconds.values().sum();
        statistics.absorb(&Statistics {
            seconds: Default::default(),
            ..spent
        });
        statistics.spend("loss_image", seconds);
        Ok(images
            .iter()
            .flat_map(|i| i.pixels.iter().flatten().copied())
            .collect())
    }

    /// Each group's gradient, by all variables one after another.
    pub fn gradients(
        &self,
        look: &Look,
        share: u32,
        adjoint: &Image,
        statistics: &mut Statistics,
    ) -> Result<Vec<f32>, Failure> {
        let settings = self.settings(look, share, self.sampling.spp, seeds::DERIVATIVE);
        let variables = &self.problem.variables;
        let counts = |p: &Parameter| {
            p.target
                .is_some_and(|t| is_seen(t, settings.sensor, look.silhouette))
        };
        let every: Vec<Parameter> = variables.iter().map(|v| v.parameter.clone()).collect();
        let wanted: Vec<Parameter> = every.iter().filter(|p| counts(p)).cloned().collect();
        let numbers: usize = variables.iter().map(|v| v.parameter.len()).sum();
        let group_number = match settings.groups {
            Some(Groups { count, only: None }) => count as usize,
            _ => 1,
        };
        if wanted.is_empty() || adjoint.pixels.iter().flatten().all(|v| *v == 0.0) {
            return Ok(vec![0.0; numbers * group_number]);
        }
        let prepared = self.prepared(look)?;
        let base = match (look.silhouette, &self.problem.silhouette) {
            (true, Some(base)) => &base.scene,
            _ => &self.problem.base.scene,
        };
        let objective = Objective::Adjoint(adjoint);
        let done = prepared
            .backward(
                &settings,
                &pose::needed(base, &wanted),
                &objective,
                self.progress,
            )
            .map_err(failed)?;
        statistics.absorb(&done.statistics);
        let mut all = Vec::with_capacity(numbers * done.groups.len());
        for group in &done.groups {
            for (which, variable) in variables.iter().enumerate() {
                match counts(&variable.parameter) {
                    true => all.extend(pose::gradient(
                        base,
                        prepared.scene,
                        &every,
                        self.values,
                        which,
                        group,
                    )),
                    false => all.resize(all.len() + variable.parameter.len(), 0.0),
                }
            }
        }
        Ok(all)
    }
}

/// Whether an image depends on a parameter: of other sensors it does not, and what shapes cover
/// depends on no colour.
fn is_seen(target: Target, sensor: usize, silhouette: bool) -> bool {
    let moves_outlines = matches!(
        target,
        Target::VertexPositions(_)
            | Target::ShapeToWorld(_)
            | Target::ShapeTranslation(_)
            | Target::ShapeRotation(_)
            | Target::ShapeScale(_)
    );
    match target.sensor() {
        Some(own) => own == sensor,
        None => moves_outlines || !silhouette,
    }
}

/// The scene with values, of which only those of shapes and cameras mean something in the mask
/// term's scene.
pub fn is_of_silhouette(parameter: &Parameter) -> bool {
    let moves = |target: Target| target.sensor().is_some() || is_seen(target, 0, true);
    parameter.target.is_some_and(moves)
}

pub fn failed(error: EngineError) -> Failure {
    Failure::from_engine(error, None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Body;

    #[test]
    fn masks_tell_of_shapes_and_of_their_own_camera() {
        let camera = [
            Target::SensorTranslation(1),
            Target::SensorRotation(1),
            Target::SensorXFov(1),
            Target::SensorToWorld(1),
            Target::SensorPrincipalPoint { sensor: 1, axis: 0 },
        ];
        for target in camera {
            assert!(is_seen(target, 1, true), "{target:?}");
            assert!(!is_seen(target, 0, true), "{target:?}");
        }
        let body = Body::of(0);
        let shapes = [
            Target::VertexPositions(0),
            Target::ShapeToWorld(body),
            Target::ShapeTranslation(body),
            Target::ShapeRotation(body),
            Target::ShapeScale(body),
        ];
        for target in shapes {
            assert!(is_seen(target, 0, true), "{target:?}");
        }
        for target in [Target::Texels(0), Target::DeltaLightPosition(0)] {
            assert!(!is_seen(target, 0, true) && is_seen(target, 0, false));
        }
    }
}
