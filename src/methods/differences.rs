//! Central finite differences with common random numbers: the reference every other method is
//! measured against; and the same with samples that are carried along with what they see.
//!
//! Russian roulette is off, since a path that ends because θ moved is a jump that no derivative
//! has.

use super::displaced_images::DisplacedImages;
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
use super::step_comparison::StepComparison;
use super::steps::Steps;
use crate::picture::Image;
use crate::scene::Rgb;
use crate::scene::parameters::{self, Parameter};
use crate::statistics::estimate::Estimate;
use std::array::from_fn;
use std::time::Instant;

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

/// A look at what those of a job would be, by its first difference alone, which has nearly all of
/// the noise; keeps the structures of the displaced scenes for who comes next.
pub fn look(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    steps: &Steps,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let displaced = Displaced::new(prepared, settings);
    let done = by_steps(&displaced, direction, &steps.first(), progress);
    prepared.parts.keep_followers(displaced.followers);
    done
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
    statistics.notes.push(steps.in_words());
    statistics.notes.extend(steps.doubt().map(String::from));
    let mut sums = Sums::default();
    let mut compared = StepComparison::default();
    displaced.render(direction, steps, progress, &mut statistics, |it| {
        sums.add(&it);
        compared.add(&it);
    })?;
    let doubt = displaced.doubt(compared, (direction, steps), progress)?;
    statistics.warnings.extend(doubt.map(String::from));
    Ok(sums.finish(statistics))
}

/// How far differences over the two steps are apart, if that is more than may be, all with the
/// samples of the settings.
pub fn apart(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    steps: &Steps,
    progress: &dyn Progress,
) -> Result<Option<f64>, EngineError> {
    let displaced = Displaced::new(prepared, settings);
    let compared = displaced.compare_evenly(direction, steps, progress)?;
    prepared.parts.keep_followers(displaced.followers);
    Ok(compared.apart())
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
        let images = steps.differences.iter().enumerate();
        let images = images.flat_map(|(number, difference)| {
            let settings = steps.settings_of(difference, &self.settings);
            [-1.0, 1.0].map(|side| ((number, difference), side, settings.clone()))
        });
        let images: Vec<_> = images.collect();
        let samples = |(_, _, settings): &(_, _, Settings)| u64::from(settings.spp);
        let all = images.iter().map(samples).sum();
        let mut before = 0;
        for image in images {
            let of_image = samples(&image);
            let ((number, difference), side, settings) = image;
            let by = side * difference.reach * step;
            let start = Instant::now();
            let mut displaced = EditedScene::new(base);
            displaced.displace(direction, by)?;
            displaced.follow(prepared.workers.threads)?;
            {
                let there = displaced.prepare(&prepared.workers, &|| progress.cancelled())?;
                statistics.add_seconds("build", start);
                let progress = Part {
                    whole: progress,
                    before,
                    part: of_image,
                    all,
                };
                let along = Along {
                    carried: steps.carried().map(|v| (v, by)),
                    black_goes_on,
                };
                let (groups, size) = group_images(&there, &settings, along, &progress, statistics)?;
                each(DisplacedImages {
                    groups,
                    size,
                    difference: number,
                    per_step: 1.0 / (2.0 * by),
                    weight: difference.weight / (2.0 * by),
                    share: difference.share,
                });
            }
            before += of_image;
            if let Some(lease) = displaced.finish() {
                self.followers.give_back(lease, || Some(Box::new(())));
            }
        }
        Ok(())
    }
}

impl Displaced<'_> {
    /// Why differences are no derivative, if what was seen of their two steps says so.
    pub fn doubt(
        &self,
        compared: StepComparison,
        (direction, steps): (&[(Parameter, Vec<f32>)], &Steps),
        progress: &dyn Progress,
    ) -> Result<Option<&'static str>, EngineError> {
        // The few samples of the longer step may have missed what is rare.
        if compared.apart().is_some() && steps.carried().is_some() {
            let evenly = self.compare_evenly(direction, steps, progress)?;
            return Ok(evenly.warning());
        }
        Ok(compared.warning())
    }

    /// Both steps with all samples.
    fn compare_evenly(
        &self,
        direction: &[(Parameter, Vec<f32>)],
        steps: &Steps,
        progress: &dyn Progress,
    ) -> Result<StepComparison, EngineError> {
        let mut compared = StepComparison::default();
        let none = &mut Statistics::default();
        let steps = steps.evenly();
        self.render(direction, &steps, progress, none, |it| compared.add(&it))?;
        Ok(compared)
    }
}

/// What the images add up to.
#[derive(Default)]
struct Sums {
    size: [usize; 2],
    /// Each group's difference.
    groups: Vec<Vec<[f64; 3]>>,
    /// The sum of all images that have all samples, and how many they are.
    sum: Vec<[f64; 3]>,
    images: usize,
}

impl Sums {
    fn add(&mut self, it: &DisplacedImages) {
        self.size = it.size;
        let pixels = it.size[0] * it.size[1];
        self.groups.resize(it.groups.len(), vec![[0.0; 3]; pixels]);
        self.sum.resize(pixels, [0.0; 3]);
        for (group, image) in self.groups.iter_mut().zip(&it.groups) {
            add(group, image, it.weight);
            if it.share == 1.0 {
                add(&mut self.sum, image, 1.0);
                self.images += 1;
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

fn add(sums: &mut [[f64; 3]], image: &[Rgb], weight: f64) {
    for (sum, value) in sums.iter_mut().zip(image) {
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += weight * f64::from(*value);
        }
    }
}

/// Progress of one of several parts.
pub struct Part<'a> {
    pub whole: &'a dyn Progress,
    /// The work before it, its own, and that of all.
    pub before: u64,
    pub part: u64,
    pub all: u64,
}

impl Progress for Part<'_> {
    fn advance(&self, done: u64, total: u64) {
        self.whole
            .advance(self.before * total + done * self.part, self.all * total);
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}
