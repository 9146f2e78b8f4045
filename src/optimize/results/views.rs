//! Renderings of the views at some values, for looking at.

use crate::jobs::failure::Failure;
use crate::methods::{EngineError, Prepared, Progress, Settings};
use crate::optimize::problem::Problem;
use crate::optimize::problem::seeds;
use crate::optimize::problem::view::View;
use crate::picture::Image;
use crate::scene::Scene;

/// The images of views of a scene, each with random numbers of its own.
pub fn render(
    problem: &Problem,
    scene: &Scene,
    views: &[View],
    progress: &dyn Progress,
) -> Result<Vec<Image>, Failure> {
    let failed = |error: EngineError| Failure::from_engine(error, None);
    let machine = &problem.machine;
    let cancelled = || progress.cancelled();
    let prepared = Prepared::with_workers(scene, &machine.workers, machine.backend, &cancelled)
        .map_err(failed)?;
    let one = |(number, view): (usize, &View)| {
        let seed = problem.config.seed;
        let settings = Settings {
            spp: problem.config.output.spp,
            seed: seeds::of(seed, [seeds::PICTURE, view.sensor as u64, number as u64]),
            resolution: view.resolution,
            sensor: view.sensor,
            ..problem.settings.clone()
        };
        Ok(prepared.render(&settings, progress).map_err(failed)?.image)
    };
    views.iter().enumerate().map(one).collect()
}

/// Peak signal to noise ratio in decibels, the peak being 1 and numbers clipped to 0…1, by the
/// weights of pixels if there are any.
pub fn psnr_db(image: &Image, target: &Image, weights: Option<&[f32]>) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for (i, (a, b)) in image.pixels.iter().zip(&target.pixels).enumerate() {
        let w = weights.map_or(1.0, |weights| f64::from(weights[i]));
        for c in 0..3 {
            let d = f64::from(a[c].clamp(0.0, 1.0)) - f64::from(b[c].clamp(0.0, 1.0));
            sum += w * d * d;
            weight += w;
        }
    }
    -10.0 * (sum / weight).log10()
}
