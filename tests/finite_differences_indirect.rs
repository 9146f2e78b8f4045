//! As `finite_differences`: colours, and light from the sky and from other surfaces.

mod common;

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::scenes::*;

#[test]
fn colours() {
    let parts: [(&str, &[f32]); 2] = [
        ("floor.bsdf.reflectance.value", &[1.0, 0.5, 0.2]),
        ("lamp.emitter.radiance.value", &[1.0, 2.0, 0.5]),
    ];
    check(&room(3), &parts, 16, None, Agrees);
    let sky = [("env.radiance.value", [1.0, 0.5, 0.7].as_slice())];
    check(&close_up().sky(SKY), &sky, 16, None, Agrees);
}

#[test]
fn lit_by_the_sky() {
    let scene = close_up().sky(SKY);
    check(
        &scene,
        &[("block.translation", &[1.0, 0.2, 0.1])],
        128,
        None,
        Fails,
    );
    check(
        &scene,
        &[("floor.rotation", &[0.5, 0.3, 0.2])],
        128,
        None,
        Fails,
    );
}

#[test]
fn indirect_light_at_depth_3() {
    check(
        &room(3),
        &[("block.translation", &[1.0, 0.2, 0.1])],
        128,
        None,
        Fails,
    );
    check(
        &room(3),
        &[("lamp.translation", &[0.5, 0.3, 1.0])],
        128,
        None,
        Fails,
    );
}

#[test]
fn indirect_light_at_depth_4() {
    check(
        &room(4),
        &[("block.translation", &[1.0, 0.2, 0.1])],
        128,
        None,
        Fails,
    );
}
