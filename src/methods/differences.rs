//! Central finite differences with common random numbers: the reference every other method is
//! measured against.
//!
//! The image is rendered at θ ± h and θ ± 2h with the same random numbers and the two central
//! differences are combined so that the error of order h² vanishes (Richardson): (4·D(h) −
//! D(2h))/3. Russian roulette is off, since a path that ends because θ moved is a jump that no
//! derivative has.

use super::carried::MOST_PIXELS;
use super::difference_step::step;
use super::error::EngineError;
use super::prepared::Prepared;
use super::progress::Progress;
use super::render::group_images;
use super::results::ForwardGradient;
use super::settings::Settings;
use super::statistics::Statistics;
use super::workers::Workers;
use crate::paths::film::drift::DriftVelocity;
use crate::picture::Image;
use crate::scene::parameters::{Parameter, displace};
use crate::scene::{Rgb, Scene};
use crate::statistics::estimate::Estimate;
use std::array::from_fn;

/// The longest step, over the usual.
const LONGEST: f64 = 2.0;

/// Renderings that one difference takes.
pub const IMAGES: usize = 4;

/// The gradient image along `direction`, by differences of the usual step. The samples may be
/// carried along with the film's drift ([`super::carried`]).
pub fn forward(
    scene: &Scene,
    workers: &Workers,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    carried: Option<DriftVelocity>,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let step = step(scene, settings, direction)?;
    let velocity = carried.map(|v| v.no_faster_than(MOST_PIXELS / (LONGEST * step)));
    by_step(
        scene,
        workers,
        settings,
        direction,
        (step, velocity.as_ref()),
        progress,
    )
}

/// The same by a step of one's own.
pub fn forward_by_step(
    scene: &Scene,
    workers: &Workers,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    step: f64,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    by_step(scene, workers, settings, direction, (step, None), progress)
}

fn by_step(
    scene: &Scene,
    workers: &Workers,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    (step, velocity): (f64, Option<&DriftVelocity>),
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let mut statistics = Statistics::default();
    let refused = |e: crate::scene::SceneError| EngineError::Refused(e.to_string());
    statistics.notes.push(format!(
        "finite differences with steps of {step:.3e} and twice that"
    ));
    let settings = Settings {
        rr_depth: u32::MAX,
        ..settings.clone()
    };
    let offsets: [f64; IMAGES] = [-LONGEST, -1.0, 1.0, LONGEST];
    // D = Σ weight·I(θ + offset·h)/h.
    let weights = [1.0, -8.0, 8.0, -1.0].map(|w| w / (12.0 * step));
    let mut sums = Sums::default();
    for (part, (offset, weight)) in offsets.into_iter().zip(weights).enumerate() {
        let moved = displace(scene, direction, offset * step).map_err(refused)?;
        let part_progress = Part {
            whole: progress,
            part: part as u64,
            parts: offsets.len() as u64,
        };
        let prepared =
            Prepared::with_workers(&moved, workers, settings.backend, &|| progress.cancelled())?;
        statistics.spend("build", prepared.build_seconds);
        let carried = velocity.map(|velocity| (velocity, offset * step));
        let (images, size) = group_images(
            &prepared,
            &settings,
            carried,
            &part_progress,
            &mut statistics,
        )?;
        sums.add(&images, size, weight);
    }
    Ok(sums.finish(statistics))
}

/// What the images add up to.
#[derive(Default)]
struct Sums {
    size: [usize; 2],
    /// Each group's difference.
    groups: Vec<Vec<[f64; 3]>>,
    /// The mean of all images.
    mean: Vec<[f64; 3]>,
}

impl Sums {
    /// Adds the groups' images of one displaced scene.
    fn add(&mut self, images: &[Vec<Rgb>], size: [usize; 2], weight: f64) {
        self.size = size;
        let pixels = size[0] * size[1];
        self.groups.resize(images.len(), vec![[0.0; 3]; pixels]);
        self.mean.resize(pixels, [0.0; 3]);
        let share = 1.0 / (IMAGES * images.len()) as f64;
        for (group, image) in self.groups.iter_mut().zip(images) {
            for ((sum, average), value) in group.iter_mut().zip(&mut self.mean).zip(image) {
                for c in 0..3 {
                    sum[c] += weight * value[c] as f64;
                    average[c] += share * value[c] as f64;
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
        ForwardGradient {
            image: image(self.mean.iter().map(|p| p.map(|x| x as f32)).collect()),
            gradient: estimates(|e| e.value),
            stderr: (self.groups.len() > 1).then(|| estimates(|e| e.error)),
            statistics,
        }
    }
}

/// Progress of one of several renderings.
struct Part<'a> {
    whole: &'a dyn Progress,
    part: u64,
    parts: u64,
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
