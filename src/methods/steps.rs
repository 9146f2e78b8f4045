//! By which differences a derivative is told, and how far they reach.
//!
//! At rest images are compared with the same random numbers at θ ± h and θ ± 2h, and the two
//! central differences are combined so that the error of order h² vanishes (Richardson): (4·D(h) −
//! D(2h))/3.
//!
//! Where samples are carried ([`super::carried`]) it is (16·D(h) − D(4h))/15: the error of order h²
//! vanishes as well, and what D(4h) has of its own counts so little that a sixteenth of the samples
//! is enough, with random numbers of their own. The step is longer, since noise falls with it: with
//! 1/h in the variance where single edges come by, and with 1/h² where there are so many that a
//! sample sees something else at every step. There differences have an error, too, whatever the
//! filter is: a leaf behind others comes and goes within a small part of a pixel, and its
//! derivative with it, and where a body turns its outline passes on from one edge to the next. So
//! above 64 samples a pixel the step falls with the fourth root of their number, which keeps that
//! error mostly a small part of the noise.

use super::carried;
use super::difference_step::{step, step_within_limits};
use super::error::EngineError;
use super::prepared::Prepared;
use super::settings::Settings;
use crate::paths::film::drift::DriftVelocity;
use crate::scene::parameters::{Parameter, tangent};
use std::slice::from_ref;
use std::sync::Arc;

/// A central difference of images.
pub struct Central {
    /// Its step over h.
    pub reach: f64,
    /// In the sum that is the derivative.
    pub weight: f64,
    /// Of the samples.
    pub share: f64,
}

impl Central {
    const fn with_all_samples(&self) -> Self {
        Self {
            reach: self.reach,
            weight: self.weight,
            share: 1.0,
        }
    }
}

/// With the same random numbers in both.
const AT_REST: &[Central] = &[
    Central {
        reach: 1.0,
        weight: 4.0 / 3.0,
        share: 1.0,
    },
    Central {
        reach: 2.0,
        weight: -1.0 / 3.0,
        share: 1.0,
    },
];
/// Each with its own.
const CARRIED: &[Central] = &[
    Central {
        reach: 1.0,
        weight: 16.0 / 15.0,
        share: 1.0,
    },
    Central {
        reach: 4.0,
        weight: -1.0 / 15.0,
        share: 1.0 / 16.0,
    },
];

/// The same with all samples in both, to compare them.
const CARRIED_EVENLY: &[Central] = &[CARRIED[0].with_all_samples(), CARRIED[1].with_all_samples()];

/// Renderings that a difference takes, and about how many one whose samples are carried.
pub const IMAGES: usize = 2 * AT_REST.len();
pub const CARRIED_IMAGES: usize = 2;

/// The step of carried differences over the usual, up to so many samples a pixel.
const LONG_STEP: f64 = 1.6;
const LONG_STEP_SPP: f64 = 64.0;

const BLUR: &str = "carried differences blur what changes within their step, as where crowds finer than a pixel \
                    hide one another or an outline passes on to another edge: that is mostly small beside this \
                    run's noise, and not in its standard errors; for more than that take more samples at once, or \
                    reparam";

/// The random numbers of differences that have their own.
const OWN_NUMBERS: u64 = 0x6469_6666_6572_0001;

fn farthest(differences: &[Central]) -> f64 {
    differences.iter().map(|d| d.reach).fold(0.0, f64::max)
}

fn carried_step(spp: u32) -> f64 {
    LONG_STEP * (LONG_STEP_SPP / f64::from(spp)).powf(0.25).min(1.0)
}

/// How far scenes are displaced, and what carries the samples meanwhile.
#[derive(Clone)]
pub struct Steps {
    pub step: f64,
    pub differences: &'static [Central],
    carried: Option<Arc<DriftVelocity>>,
}

impl Steps {
    /// The usual, by the method of the settings.
    pub fn usual(
        prepared: &Prepared,
        settings: &Settings,
        direction: &[(Parameter, Vec<f32>)],
    ) -> Result<Self, EngineError> {
        let step = step(prepared.scene, settings, direction)?;
        let velocity = match settings.method.carries_samples() {
            true => carried::velocity(prepared, settings, direction)?,
            false => None,
        };
        let Some(velocity) = velocity else {
            return Ok(Self::at_rest(step));
        };
        let tangent = tangent(prepared.scene, direction, settings.sensor)?;
        // The farthest image is no farther than that of differences at rest.
        let most =
            step_within_limits(prepared.scene, &tangent) * farthest(AT_REST) / farthest(CARRIED);
        let step = (step * carried_step(settings.spp)).min(most);
        let velocity = velocity.no_faster_than(carried::MOST_PIXELS / step);
        Ok(Self {
            step,
            differences: CARRIED,
            carried: Some(Arc::new(velocity)),
        })
    }

    /// Of samples at rest.
    pub fn at_rest(step: f64) -> Self {
        Self {
            step,
            differences: AT_REST,
            carried: None,
        }
    }

    /// The first difference alone where the others have samples of their own.
    pub fn first(&self) -> Self {
        let differences = match self.carried {
            Some(_) => &self.differences[..1],
            None => self.differences,
        };
        Self {
            differences,
            ..self.clone()
        }
    }

    /// All differences with the same samples.
    pub fn evenly(&self) -> Self {
        let differences = match self.carried {
            Some(_) => CARRIED_EVENLY,
            None => self.differences,
        };
        Self {
            differences,
            ..self.clone()
        }
    }

    /// What carries the samples, if anything does.
    pub fn carried(&self) -> Option<&DriftVelocity> {
        self.carried.as_deref()
    }

    /// Scenes that are displaced.
    pub fn scenes(&self) -> usize {
        2 * self.differences.len()
    }

    /// The mean square of what a path's difference changes by where its radiance jumps by `jump`,
    /// and which brings `brings` to the derivative.
    pub fn mean_square_of_jump(&self, brings: f64, jump: f64) -> f64 {
        let square: f64 = match self.carried {
            Some(_) => {
                let own = |d: &Central| square_of_share(from_ref(d)) / d.share;
                self.differences.iter().map(own).sum()
            }
            None => square_of_share(self.differences),
        };
        // No more than all paths can change.
        let most = jump / (2.0 * self.step);
        brings.min(most) * jump * square / self.step
    }

    /// The settings of a difference: it has its share of the samples, and one of each group at
    /// least.
    pub fn settings_of(&self, difference: &Central, settings: &Settings) -> Settings {
        if difference.share == 1.0 {
            return settings.clone();
        }
        let groups = settings.groups();
        let of_group = f64::from(settings.spp) * difference.share / f64::from(groups.count);
        Settings {
            spp: groups.count * (of_group.round() as u32).max(1),
            groups: Some(groups),
            seed: settings.seed ^ OWN_NUMBERS,
            ..settings.clone()
        }
    }

    /// Samples of all differences over those of the first.
    pub fn work_over_first(&self, settings: &Settings) -> f64 {
        let samples = |d: &Central| f64::from(self.settings_of(d, settings).spp);
        let all: f64 = self.differences.iter().map(samples).sum();
        all / samples(&self.first().differences[0])
    }

    pub fn in_words(&self) -> String {
        let steps = self.differences.iter().map(|d| d.reach * self.step);
        let steps: Vec<_> = steps.map(|by| format!("{by:.3e}")).collect();
        format!("finite differences with steps of {}", steps.join(" and "))
    }

    /// What standard errors do not tell of.
    pub fn doubt(&self) -> Option<&'static str> {
        self.carried.is_some().then_some(BLUR)
    }
}

/// An edge that comes by when θ has changed by t·h jumps in those differences that reach as far.
/// What they add up to then is a part of the jump over h; this is the integral of its square over
/// t, if all differences have the same samples.
fn square_of_share(differences: &[Central]) -> f64 {
    let over_step = |d: &Central| d.weight / (2.0 * d.reach);
    let mut nearer = 0.0;
    let mut square = 0.0;
    for (i, difference) in differences.iter().enumerate() {
        let share: f64 = differences[i..].iter().map(over_step).sum();
        square += 2.0 * (difference.reach - nearer) * share * share;
        nearer = difference.reach;
    }
    square
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_shorten_with_samples() {
        let steps = [1, 64, 1024].map(carried_step);
        assert!(steps[0] == LONG_STEP && steps[1] == LONG_STEP);
        assert!((steps[2] - LONG_STEP / 2.0).abs() < 1e-12);
    }

    /// Differences of powers of θ around zero: all up to the fourth are right.
    #[test]
    fn cubes_are_differentiated() {
        for differences in [AT_REST, CARRIED] {
            let of_power = |power: i32| -> f64 {
                let one = |d: &Central| d.weight * d.reach.powi(power - 1);
                differences.iter().map(one).sum()
            };
            assert!((of_power(1) - 1.0).abs() < 1e-12 && of_power(3).abs() < 1e-12);
        }
    }
}
