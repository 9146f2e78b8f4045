//! Central finite differences with common random numbers: the reference every other method is
//! measured against.
//!
//! The image is rendered at θ ± h and θ ± 2h with the same random numbers and the two central
//! differences are combined so that the error of order h² vanishes (Richardson): (4·D(h) −
//! D(2h))/3. Russian roulette is off, since a path that ends because θ moved is a jump that no
//! derivative has.
//!
//! Where samples are carried ([`super::carried`]) it is D(h) alone, half the images and, of what
//! jumps, 0.72 of the variance or less. Its step is the usual up to 64 samples a pixel, and then
//! falls with the fifth root of their number, so that its error, which falls with h², stays below
//! the noise.

use super::carried;
use super::difference_step::step;
use super::edited::{Base, EditedScene};
use super::error::EngineError;
use super::followers::Followers;
use super::parts::Parts;
use super::prepared::Prepared;
use super::progress::Progress;
use super::refusals;
use super::render::{Along, group_images};
use super::results::ForwardGradient;
use super::settings::Settings;
use super::statistics::Statistics;
use crate::paths::film::drift::DriftVelocity;
use crate::picture::Image;
use crate::scene::Rgb;
use crate::scene::parameters::{self, Parameter};
use crate::statistics::estimate::Estimate;
use std::array::from_fn;
use std::time::Instant;

/// Displaced scenes: how far over h, and D·h is the sum of their images times these.
type Scheme = &'static [(f64, f64)];

const RICHARDSON: Scheme = &[
    (-2.0, 1.0 / 12.0),
    (-1.0, -8.0 / 12.0),
    (1.0, 8.0 / 12.0),
    (2.0, -1.0 / 12.0),
];
const CENTRAL: Scheme = &[(-1.0, -0.5), (1.0, 0.5)];

/// Renderings that a difference takes, and one whose samples are carried.
pub const IMAGES: usize = RICHARDSON.len();
pub const CARRIED_IMAGES: usize = CENTRAL.len();

/// Samples a pixel up to which the step of carried differences is the usual.
const FULL_STEP_SPP: f64 = 64.0;

/// The step of carried differences over the usual, for this many samples a pixel.
pub fn carried_step(spp: u32) -> f64 {
    (FULL_STEP_SPP / f64::from(spp)).powf(0.2).min(1.0)
}

/// The gradient image along `direction`, by differences of the usual step; the samples are carried
/// along with what they see if the method does that ([`super::carried`]).
pub fn forward(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let steps = Steps::usual(prepared, settings, direction)?;
    let displaced = Displaced::new(prepared, settings);
    by_steps(&displaced, direction, &steps, progress)
}

/// The same, and whether samples are carried; keeps the structures of the displaced scenes for who
/// comes next.
pub fn forward_of_pilot(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    progress: &dyn Progress,
) -> Result<(ForwardGradient, bool), EngineError> {
    let steps = Steps::usual(prepared, settings, direction)?;
    let displaced = Displaced::new(prepared, settings);
    let done = by_steps(&displaced, direction, &steps, progress);
    prepared.parts.keep_followers(displaced.followers);
    Ok((done?, steps.carried.is_some()))
}

/// The same by a step of one's own, with samples at rest.
pub fn forward_by_step(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    step: f64,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let steps = Steps::at_rest(step);
    let displaced = Displaced::new(prepared, settings);
    by_steps(&displaced, direction, &steps, progress)
}

fn by_steps(
    displaced: &Displaced,
    direction: &[(Parameter, Vec<f32>)],
    steps: &Steps,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let mut statistics = Statistics::default();
    statistics.notes.push(format!(
        "finite differences with steps of {}",
        steps.in_words()
    ));
    let mut sums = Sums::default();
    displaced.render(direction, steps, progress, &mut statistics, |it| {
        sums.add(&it.groups, it.size, it.weight);
    })?;
    Ok(sums.finish(statistics))
}

/// How far scenes are displaced, and what carries the samples meanwhile.
pub struct Steps {
    step: f64,
    scheme: Scheme,
    carried: Option<DriftVelocity>,
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
        let step = step * carried_step(settings.spp);
        Ok(Self {
            step,
            scheme: CENTRAL,
            carried: Some(velocity.no_faster_than(carried::MOST_PIXELS / step)),
        })
    }

    /// Of samples at rest.
    pub fn at_rest(step: f64) -> Self {
        Self {
            step,
            scheme: RICHARDSON,
            carried: None,
        }
    }

    /// What carries the samples, if anything does.
    pub fn carried(&self) -> Option<&DriftVelocity> {
        self.carried.as_ref()
    }

    /// The mean square of what a path's difference changes by where its radiance jumps by `jump`,
    /// and which brings `brings` to the derivative.
    pub fn mean_square_of_jump(&self, brings: f64, jump: f64) -> f64 {
        // Between two displaced scenes, with the weights of those to one side of it.
        let mut square = 0.0;
        let mut weight = 0.0;
        for pair in self.scheme.windows(2) {
            let [(from, w), (to, _)] = [pair[0], pair[1]];
            weight += w;
            square += (to - from) * weight * weight;
        }
        // No more than all paths can change.
        let most = jump / (2.0 * self.step);
        brings.min(most) * jump * square / self.step
    }

    fn in_words(&self) -> String {
        let all = self.scheme.iter().map(|(offset, _)| offset * self.step);
        let words = all.filter(|by| *by > 0.0).map(|by| format!("{by:.3e}"));
        words.collect::<Vec<_>>().join(" and ")
    }
}

/// The images of one displaced scene.
pub struct DisplacedImages {
    /// Of each group of samples.
    pub groups: Vec<Vec<Rgb>>,
    pub size: [usize; 2],
    /// The difference is the sum of all images times theirs.
    pub weight: f64,
}

/// Renders displaced scenes.
pub struct Displaced<'a> {
    prepared: &'a Prepared<'a>,
    parts: Parts,
    settings: Settings,
    followers: Followers,
}

impl<'a> Displaced<'a> {
    pub fn new(prepared: &'a Prepared<'a>, settings: &Settings) -> Self {
        Self {
            prepared,
            parts: prepared.parts.unlinked(),
            settings: Settings {
                rr_depth: u32::MAX,
                ..settings.clone()
            },
            followers: prepared.parts.take_followers(settings.backend),
        }
    }

    /// The images of one difference, one scene after another.
    pub fn render(
        &self,
        direction: &[(Parameter, Vec<f32>)],
        steps: &Steps,
        progress: &dyn Progress,
        statistics: &mut Statistics,
        mut each: impl FnMut(DisplacedImages),
    ) -> Result<(), EngineError> {
        let prepared = self.prepared;
        let step = steps.step;
        let base = Base {
            scene: prepared.scene,
            parts: &self.parts,
            followers: &self.followers,
        };
        let moving: Vec<_> = direction.iter().map(|(p, _)| p.clone()).collect();
        let request = parameters::wanted(prepared.scene, &moving, self.settings.sensor)?;
        let black_goes_on = refusals::asks_about_black(prepared.scene, &request);
        for (part, (offset, weight)) in steps.scheme.iter().enumerate() {
            let start = Instant::now();
            let mut displaced = EditedScene::new(base);
            displaced.displace(direction, offset * step)?;
            displaced.follow(prepared.workers.threads)?;
            {
                let there = displaced.prepare(&prepared.workers, &|| progress.cancelled())?;
                statistics.add_seconds("build", start);
                let progress = Part {
                    whole: progress,
                    part: part as u64,
                    parts: steps.scheme.len() as u64,
                };
                let along = Along {
                    carried: steps.carried.as_ref().map(|v| (v, offset * step)),
                    black_goes_on,
                };
                let (groups, size) =
                    group_images(&there, &self.settings, along, &progress, statistics)?;
                each(DisplacedImages {
                    groups,
                    size,
                    weight: weight / step,
                });
            }
            if let Some(lease) = displaced.finish() {
                self.followers.give_back(lease, || Some(Box::new(())));
            }
        }
        Ok(())
    }
}

/// What the images add up to.
#[derive(Default)]
struct Sums {
    size: [usize; 2],
    /// Each group's difference.
    groups: Vec<Vec<[f64; 3]>>,
    /// The sum of all images, and how many they are.
    sum: Vec<[f64; 3]>,
    images: usize,
}

impl Sums {
    /// Adds the groups' images of one displaced scene.
    fn add(&mut self, images: &[Vec<Rgb>], size: [usize; 2], weight: f64) {
        self.size = size;
        let pixels = size[0] * size[1];
        self.groups.resize(images.len(), vec![[0.0; 3]; pixels]);
        self.sum.resize(pixels, [0.0; 3]);
        self.images += images.len();
        for (group, image) in self.groups.iter_mut().zip(images) {
            for ((sum, all), value) in group.iter_mut().zip(&mut self.sum).zip(image) {
                for c in 0..3 {
                    sum[c] += weight * value[c] as f64;
                    all[c] += value[c] as f64;
                }
            }
        }
    }

    fn finish(self, statistics: Statistics) -> ForwardGradient {
        let [width, height] = self.size;
        let image = |pixels: Vec<Rgb>| Image {
            width,
            height,
            pixels,
        };
        let estimates = |of: fn(Estimate) -> f64| {
            let number = |i: usize, c: usize| {
                of(Estimate::mean_of(self.groups.iter().map(move |g| g[i][c]))) as f32
            };
            let pixels = 0..width * height;
            image(pixels.map(|i| from_fn(|c| number(i, c))).collect())
        };
        let mean = |sum: f64| (sum / self.images as f64) as f32;
        ForwardGradient {
            image: image(self.sum.iter().map(|p| p.map(mean)).collect()),
            gradient: estimates(|e| e.value),
            stderr: (self.groups.len() > 1).then(|| estimates(|e| e.error)),
            statistics,
        }
    }
}

/// Progress of one of several parts that take as long.
pub struct Part<'a> {
    pub whole: &'a dyn Progress,
    pub part: u64,
    pub parts: u64,
}

impl Progress for Part<'_> {
    fn advance(&self, done: u64, total: u64) {
        self.whole
            .advance(self.part * total + done, self.parts * total);
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_shorten_with_samples() {
        let steps = [1, 64, 2048].map(carried_step);
        assert!(steps[0] == 1.0 && steps[1] == 1.0 && (steps[2] - 0.5).abs() < 1e-12);
    }
}
