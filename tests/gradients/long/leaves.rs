//! Thin things on the film: the table of docs/method.md, with `--nocapture`.

use common::comparison::foliage;
use common::scenes::Build;
use common::statistics::Estimate;
use common::{differences, direction, dot, gradient, settings};
use warpath::methods::Method;

const RUNS: usize = 96;
const REFERENCE_RUNS: usize = 12;
const SIGMAS: f64 = 4.0;

/// The mean of images, and the sum over pixels of its variance.
fn mean(runs: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let pixels = (0..runs[0].len()).map(|i| {
        let values: Vec<f64> = runs.iter().map(|run| run[i]).collect();
        Estimate::mean(&values)
    });
    let pixels: Vec<Estimate> = pixels.collect();
    let variance = pixels.iter().map(|p| p.error * p.error).sum();
    (pixels.into_iter().map(|p| p.value).collect(), variance)
}

#[test]
fn leaves_before_the_sky() {
    let scene = foliage().depth(1);
    let along = direction(&scene, &[("leaves.translation", &[1.0, 0.2, 0.1])]);
    let reference: Vec<Vec<f64>> = (0..REFERENCE_RUNS as u64)
        .map(|run| {
            let settings = settings(&scene, Method::Fd, 16384, 1000 + run);
            differences(&scene, &settings, &along, 2e-3)
        })
        .collect();
    let (truth, truth_variance) = mean(&reference);
    let norm = dot(&truth, &truth);
    let amplitude = |run: &Vec<f64>| dot(run, &truth) / norm;
    let of_reference = Estimate::mean(&reference.iter().map(amplitude).collect::<Vec<_>>());
    for spp in [16, 64, 256] {
        let runs: Vec<Vec<f64>> = (0..RUNS as u64)
            .map(|run| {
                gradient(
                    &scene,
                    &settings(&scene, Method::Reparam, spp, 100 + run),
                    &along,
                )
            })
            .collect();
        let (ours, variance) = mean(&runs);
        let square: f64 = ours.iter().zip(&truth).map(|(a, b)| (a - b).powi(2)).sum();
        let ours = Estimate::mean(&runs.iter().map(amplitude).collect::<Vec<_>>());
        println!(
            "{spp} samples: error of the mean {:.3} (expected {:.3}), of one run {:.3}, amplitude {:.4} +- {:.4}",
            (square / norm).sqrt(),
            ((variance + truth_variance) / norm).sqrt(),
            (variance * RUNS as f64 / norm).sqrt(),
            ours.value,
            ours.error,
        );
        let error = ours.error.hypot(of_reference.error);
        assert!(
            (ours.value - 1.0).abs() <= SIGMAS * error,
            "{spp}: {ours:?}"
        );
    }
}
