//! Paths as long as they may be see all that lights bring to their last vertex.

use common::materials::Paint;
use common::scenes::*;
use common::statistics::Estimate;
use common::{flat, settings};
use glam::{Vec3, vec3};
use warpath::methods::{self, Method};
use warpath::scene::Distribution::Ggx;
use warpath::scene::Scene;

/// Four standard errors of means with 31 degrees of freedom.
const SIGMAS: f64 = 4.0;
const RUNS: u64 = 32;

/// A plane in which a lamp is reflected: the lamp is black, so that longer paths bring nothing
/// more.
fn plane(depth: u32) -> Scene {
    scene(vec3(0.0, -3.0, 1.5), Vec3::ZERO, 30.0, [6, 6], BOX)
        .depth(depth)
        .solid("floor", floor(2.0, 0.0), [0.5; 3])
        .light("lamp", ceiling(vec3(0.0, 2.0, 1.5), 1.0), [5.0, 6.0, 4.0])
}

/// The mean of the image.
fn brightness(scene: &Scene) -> Estimate {
    let runs: Vec<f64> = (0..RUNS)
        .map(|seed| {
            let settings = settings(scene, Method::Interior, 64, seed);
            let image = methods::render(scene, &settings, &common::Quiet).expect("an image");
            let image = flat(&image.image);
            image.iter().sum::<f64>() / image.len() as f64
        })
        .collect();
    Estimate::mean(&runs)
}

#[test]
fn narrow_lobes_show_lamps_there_too() {
    type Painted = fn(Scene) -> Scene;
    let materials: [(&str, Painted); 7] = [
        ("smooth plastic", |s| s.plastic("floor", None)),
        ("plastic of 0.02", |s| s.plastic("floor", Some(0.02))),
        ("plastic of 0.1", |s| s.plastic("floor", Some(0.1))),
        ("plastic of 0.3", |s| s.plastic("floor", Some(0.3))),
        ("metal of 0.02", |s| s.metal("floor", 0.02, Ggx)),
        ("metal of 0.3", |s| s.metal("floor", 0.3, Ggx)),
        ("glass of 0.05", |s| s.glass("floor", 0.05)),
    ];
    for (what, paint) in materials {
        let [last, further] = [2, 3].map(|depth| brightness(&paint(plane(depth))));
        let error = last.error.hypot(further.error);
        let difference = last.value - further.value;
        println!("{what}: {last:?}, {further:?}");
        assert!(
            difference.abs() <= SIGMAS * error,
            "{what}: {last:?} with two segments, {further:?} with three"
        );
        assert!(
            error < 0.05 * further.value,
            "{what}: {error} tells nothing"
        );
    }
}
