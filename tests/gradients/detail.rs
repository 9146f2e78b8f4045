//! Bodies that see their own edges near by: the film follows them where they move.

use common::comparison::{Interior::Fails, check_to, lit};
use common::scenes::*;
use common::transposition::transposed;
use common::{direction, gradient, settings};
use glam::vec3;
use warpath::methods::Method;
use warpath::scene::{Filter, Scene};

/// Between the spikes of a ball light goes back and forth.
fn thorns(filter: Filter) -> Scene {
    let from = vec3(0.3, -3.4, 1.9);
    let at = vec3(0.0, 0.0, 0.4);
    lit(scene(from, at, 20.0, [16; 2], filter)
        .solid("floor", floor(0.8, 0.0), [0.6, 0.5, 0.4])
        .solid("thorns", spiky(at, 0.45, [1.0, 0.5]), [0.8, 0.7, 0.6]))
    .depth(4)
}

const MOVED: [(&str, &[f32]); 1] = [("thorns.translation", &[1.0, 0.3, 0.2])];
const CAMERA: [(&str, &[f32]); 1] = [("cam.translation", &[1.0, 0.3, 0.2])];

#[test]
fn of_a_body_that_moves() {
    check_to(0.03, &thorns(GAUSSIAN), &MOVED, 256, None, Fails);
}

#[test]
fn under_a_moving_camera() {
    check_to(0.03, &thorns(GAUSSIAN), &CAMERA, 256, None, Fails);
}

#[test]
fn transposition() {
    transposed(&thorns(GAUSSIAN), Method::Reparam, &[]);
}

/// Mean over pixels of the variance between runs.
fn variance(scene: &Scene, seeds: std::ops::Range<u64>) -> f64 {
    let along = direction(scene, &MOVED);
    let count = (seeds.end - seeds.start) as f64;
    let of = |seed| gradient(scene, &settings(scene, Method::Reparam, 64, seed), &along);
    let runs: Vec<Vec<f64>> = seeds.map(of).collect();
    let pixels = runs[0].len();
    let of_pixel = |i: usize| {
        let mean = runs.iter().map(|r| r[i]).sum::<f64>() / count;
        runs.iter().map(|r| (r[i] - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    (0..pixels).map(of_pixel).sum::<f64>() / pixels as f64
}

/// Over a filter that jumps the film cannot follow anything, which tells what following is worth.
#[test]
fn following_is_less_noise() {
    let [box_filter, smooth] = [BOX, GAUSSIAN].map(thorns);
    let ratio: Vec<f64> = [1..7, 7..13, 13..19, 19..25]
        .map(|seeds| variance(&box_filter, seeds.clone()) / variance(&smooth, seeds))
        .into();
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| *r > 10.0), "{ratio:?}");
}
