//! Projectors: the border of what they show, wherever it is seen, against finite differences, and
//! the other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Mat3, Vec3, vec2, vec3};
use std::f32::consts::PI;
use warpath::methods::Method;
use warpath::scene::{Beam, BeamProfile, DeltaLightKind, Scene};

/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);
const MOVED: [f32; 3] = [1.0, 0.2, 0.1];

/// An even picture from above, askew.
fn shown(scene: Scene) -> Scene {
    let position = vec3(0.2, -0.1, 2.4);
    let kind = DeltaLightKind::Point { position };
    let mut scene = scene.delta_light("bulb", kind, [0.8, 0.7, 0.6]);
    let to_local = Mat3::from_rotation_z(0.4) * Mat3::from_rotation_x(PI - 0.15);
    let light = scene.delta_lights.last_mut().expect("a light");
    light.beam = Some(Beam {
        to_local,
        profile: BeamProfile::Projector {
            half_tangents: vec2(0.22, 0.16),
            scale: 1.0,
            axis: to_local.transpose() * Vec3::Z,
        },
    });
    scene
}

fn checked(scene: &Scene, key: &str, by: &[f32], spp: u32, step: Option<f64>) {
    println!("{key}");
    check_to(0.03, scene, &[(key, by)], spp, step, Fails);
}

fn block_below() -> Scene {
    let low = placed(
        cuboid(vec3(0.3, 0.25, 0.1)),
        vec3(12.0, 25.0, 33.0),
        vec3(0.3, 0.0, 0.25),
    );
    small_floor().solid("block", low, [0.3, 0.6, 0.5])
}

#[test]
fn on_what_is_seen() {
    let scene = shown(block_below());
    checked(&scene, "bulb.position", &[1.0, 0.3, 0.6], 128, STEP);
    checked(&scene, "block.translation", &MOVED, 128, STEP);
    checked(&scene, "floor.translation", &[0.1, 0.2, 1.0], 128, STEP);
    checked(&scene, "cam.translation", &MOVED, 128, STEP);
}

#[test]
fn on_what_is_curved() {
    let mut scene = shown(small_floor().depth(2));
    scene.meshes.clear();
    let scene = scene.smooth("hill", ball(3, vec3(0.1, 0.0, -0.4), 0.9), [0.6, 0.5, 0.4]);
    checked(&scene, "bulb.position", &[1.0, 0.3, 0.6], 128, STEP);
    checked(&scene, "hill.translation", &MOVED, 128, STEP);
}

#[test]
fn in_a_mirror() {
    let wall = parallelogram(vec3(-0.9, 0.9, -0.1), Vec3::X * 1.8, Vec3::Z * 1.6);
    let seen = scene(
        vec3(0.3, -3.4, 2.2),
        vec3(0.0, 0.9, 0.5),
        14.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
    .solid("wall", wall, [0.5; 3])
    .depth(3)
    .mirror("wall");
    let scene = shown(seen);
    checked(&scene, "bulb.position", &[1.0, 0.3, 0.6], 128, STEP);
    checked(&scene, "wall.rotation", &[0.1, 0.0, 0.2], 128, STEP);
}

/// The wall sees the floor, on which the picture moves.
#[test]
fn over_lobes() {
    let wall = parallelogram(vec3(-0.9, 0.7, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let at = vec3(0.0, 0.7, 0.5);
    let seen = scene(vec3(0.3, -3.4, 2.2), at, 8.0, [8; 2], GAUSSIAN)
        .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
        .solid("wall", wall, [0.8, 0.7, 0.6])
        .depth(3);
    let scene = shown(seen);
    checked(&scene, "bulb.position", &[1.0, 0.3, 0.6], 512, Some(0.005));
    let metal = scene.metal("wall", 0.05, warpath::scene::Distribution::Ggx);
    checked(&metal, "bulb.position", &[1.0, 0.3, 0.6], 1024, Some(0.002));
}

#[test]
fn transposition() {
    let painted = "wall.bsdf.brdf_0.reflectance.value";
    let wall = parallelogram(vec3(-0.9, 0.5, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let scene = block_below()
        .solid("wall", wall, [0.5; 3])
        .depth(4)
        .mirror("wall");
    transposed(&shown(scene), Method::Reparam, &[painted]);
}
