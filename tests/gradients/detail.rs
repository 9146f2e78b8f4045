//! Bodies that see their own edges near by: the film follows them where they move.

use common::comparison::{Interior::Fails, check_to, lit};
use common::noise_ratios;
use common::scenes::*;
use common::transposition::transposed;
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

/// Over a filter that jumps the film cannot follow anything, which tells what following is worth.
#[test]
fn following_is_less_noise() {
    let [box_filter, smooth] = [BOX, GAUSSIAN].map(thorns);
    let ratio = noise_ratios(
        [&box_filter, &smooth],
        &MOVED,
        [1..7, 7..13, 13..19, 19..25],
    );
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| *r > 10.0), "{ratio:?}");
}
