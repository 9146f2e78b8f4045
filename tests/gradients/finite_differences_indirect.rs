//! As `finite_differences`: colours, and light from the sky and from other surfaces.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::scenes::*;
use glam::{Vec3, vec3};

#[test]
fn colours() {
    let parts: [(&str, &[f32]); 2] = [
        ("floor.bsdf.reflectance.value", &[1.0, 0.5, 0.2]),
        ("lamp.emitter.radiance.value", &[1.0, 2.0, 0.5]),
    ];
    check(&room(3), &parts, 16, None, Agrees);
    let sky = [("env.radiance.value", [1.0, 0.5, 0.7].as_slice())];
    check(
        &close_up().constant_environment(SKY),
        &sky,
        16,
        None,
        Agrees,
    );
}

#[test]
fn lit_by_the_sky() {
    let scene = close_up().constant_environment(SKY);
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

/// Paths in a closed room have no end of their own where nothing absorbs them wholly, and
/// differences allow no roulette.
#[test]
fn endless_paths_of_a_closed_room() {
    let inside = cuboid(Vec3::splat(1.0));
    let scene = scene(vec3(0.2, -0.7, 0.1), vec3(0.0, 1.0, 0.0), 60.0, [6; 2], BOX)
        .depth(u32::MAX)
        .solid("room", inside, [0.7, 0.6, 0.5])
        .light("lamp", ceiling(vec3(0.0, 0.0, 0.9), 0.2), [5.0, 6.0, 4.0]);
    let parts: [(&str, &[f32]); 1] = [("room.bsdf.reflectance.value", &[1.0, 0.5, 0.2])];
    check(&scene, &parts, 16, None, Agrees);
}
