//! Two planes that pass through each other under an even sky, against the closed form.
//!
//! A plate stands in a floor and leans toward the eye by β. From both of them, on the eye's side,
//! the sky is seen in a lune of the angle β over the horizon, so that each has the radiance ρ L (1
//! − cos β)/2, right up to the line in which they meet. The film is so narrow that what is seen of
//! it is even. When the plate moves away by δ the line rises on the film by the change of atan(h/(a
//! + δ)), for an eye at height h and distance a.
//!
//! A pixel is some hundredth of a unit wide: what lies a thousandth of that beside the line is
//! nearer to the other plane than rays keep from the surfaces that they leave. The planes must be
//! large for that: past the ends of planes of a tenth of the size so much of the sky is seen that
//! the gradient is off by 0.8 %.

use common::scenes::*;
use common::statistics::Estimate;
use common::{direction, gradient, settings};
use glam::{Vec3, vec3};
use warpath::methods::Method;

const SKY: f64 = 2.0;
const RHO: [f64; 2] = [0.7, 0.2];
const LEAN_DEG: f64 = 60.0;
const EYE: [f64; 2] = [3.0, 0.6];
const X_FOV_DEG: f64 = 0.5;
const RUNS: u64 = 128;

#[test]
fn a_plate_in_a_floor() {
    let (sin, cos) = LEAN_DEG.to_radians().sin_cos();
    let far = 200.0;
    let up = vec3(-cos as f32, 0.0, sin as f32) * far;
    let along = vec3(0.0, far, 0.0);
    let plate = parallelogram(-along - up, 2.0 * along, 2.0 * up);
    let [away, height] = EYE;
    let eye = vec3(-away as f32, 0.0, height as f32);
    let scene = scene(eye, Vec3::ZERO, X_FOV_DEG as f32, [4, 4], BOX)
        .solid("floor", floor(far, 0.0), [RHO[0] as f32; 3])
        .solid("plate", plate, [RHO[1] as f32; 3])
        .constant_environment([SKY as f32; 3]);

    let rise = height / (away * away + height * height);
    let film = 2.0 * (0.5 * X_FOV_DEG).to_radians().tan();
    let jump = (RHO[0] - RHO[1]) * SKY * (1.0 - cos) / 2.0;
    let truth = jump * rise / film;

    let along = direction(&scene, &[("plate.translation", &[1.0, 0.0, 0.0])]);
    let run = |seed| {
        let settings = settings(&scene, Method::Reparam, 256, seed);
        let image = gradient(&scene, &settings, &along);
        image.iter().sum::<f64>() / image.len() as f64
    };
    let ours = Estimate::mean(&(1..=RUNS).map(run).collect::<Vec<f64>>());
    println!("truth {truth:.5}: {:.5} ± {:.5}", ours.value, ours.error);
    assert!(ours.error < 0.003 * truth, "nothing can be said");
    assert!(ours.z(truth).abs() < 4.0, "{} ± {}", ours.value, ours.error);
}
