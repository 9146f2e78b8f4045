//! Points of surfaces lie on them, however slender their triangles are.

use common::scenes::*;
use common::{Quiet, flat, settings};
use glam::{DQuat, DVec3, Vec3, vec3};
use std::f64::consts::TAU;
use warpath::methods::{self, Method};
use warpath::scene::Scene;

const SECTORS: u32 = 256;

/// A tilted tube of thin long triangles that fills the film. It is convex, so that all of it sees
/// the whole sky.
fn tube() -> Scene {
    let turn = DQuat::from_rotation_y(0.5);
    let point = |i: u32| {
        let angle = TAU * f64::from(i / 2 % SECTORS) / f64::from(SECTORS);
        let z = f64::from(i % 2) - 0.5;
        (turn * DVec3::new(0.3 * angle.cos(), 0.3 * angle.sin(), z)).as_vec3()
    };
    let count = 2 * SECTORS;
    let side = |first: u32| {
        let [a, b] = [first, (first + 2) % count];
        [[a, b, b + 1], [a, b + 1, a + 1]]
    };
    let triangles = (0..count).step_by(2).flat_map(side).collect();
    scene(vec3(0.0, -5.0, 0.0), Vec3::ZERO, 2.0, [8; 2], BOX)
        .solid(
            "tube",
            ((0..count).map(point).collect(), triangles),
            [0.5; 3],
        )
        .constant_environment([1.0; 3])
        .depth(2)
}

#[test]
fn slender_triangles_do_not_hide_the_sky_from_themselves() {
    let scene = tube();
    let settings = settings(&scene, Method::Interior, 64, 1);
    let image = methods::render(&scene, &settings, &Quiet).expect("an image");
    for value in flat(&image.image) {
        assert!((value - 0.5).abs() < 1e-5, "{value}");
    }
}
