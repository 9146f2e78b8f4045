//! The borders of beams, of projectors' pictures and of spots without a ramp, wherever they are
//! seen: against finite differences, and the other sweep.

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
const BULB_MOVED: [f32; 3] = [1.0, 0.3, 0.6];

/// From above, askew.
fn beam(scene: Scene, power: [f32; 3], to_local: Mat3, profile: BeamProfile) -> Scene {
    let position = vec3(0.2, -0.1, 2.4);
    let mut scene = scene.delta_light("bulb", DeltaLightKind::Point { position }, power);
    let light = scene.delta_lights.last_mut().expect("a light");
    light.beam = Some(Beam { to_local, profile });
    scene
}

/// An even picture.
fn projector(scene: Scene) -> Scene {
    let to_local = Mat3::from_rotation_z(0.4) * Mat3::from_rotation_x(PI - 0.15);
    let profile = BeamProfile::Projector {
        half_tangents: vec2(0.22, 0.16),
        scale: 1.0,
        axis: to_local.transpose() * Vec3::Z,
    };
    beam(scene, [0.8, 0.7, 0.6], to_local, profile)
}

/// As bright at its cutoff as within, and wider one way than the other.
fn spot(scene: Scene) -> Scene {
    let stretched = Mat3::from_diagonal(vec3(0.8, 1.0, 1.1));
    let profile = BeamProfile::Spot {
        beam_width_rad: 0.21,
        cutoff_rad: 0.21,
        texture: None,
    };
    let to_local = stretched * Mat3::from_rotation_x(PI - 0.15);
    beam(scene, [4.0, 3.0, 2.0], to_local, profile)
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
fn pictures_on_what_is_seen() {
    let scene = projector(block_below());
    checked(&scene, "bulb.position", &BULB_MOVED, 128, STEP);
    checked(&scene, "block.translation", &MOVED, 128, STEP);
    checked(&scene, "floor.translation", &[0.1, 0.2, 1.0], 128, STEP);
    checked(&scene, "cam.translation", &MOVED, 128, STEP);
}

#[test]
fn spots_on_what_is_seen() {
    let scene = spot(block_below());
    // Wider differences are off where the border crosses the block's edges.
    checked(&scene, "bulb.position", &BULB_MOVED, 1024, Some(0.003));
    checked(&scene, "block.translation", &MOVED, 128, STEP);
    checked(&scene, "cam.translation", &MOVED, 128, STEP);
}

#[test]
fn pictures_on_what_is_curved() {
    let mut scene = projector(small_floor().depth(2));
    scene.meshes.clear();
    let scene = scene.smooth("hill", ball(3, vec3(0.1, 0.0, -0.4), 0.9), [0.6, 0.5, 0.4]);
    checked(&scene, "bulb.position", &BULB_MOVED, 128, STEP);
    checked(&scene, "hill.translation", &MOVED, 128, STEP);
}

/// A floor, for mirrors over it.
fn mirrored(look_at: Vec3, fov: f32) -> Scene {
    let eye = vec3(0.3, -3.4, 2.2);
    scene(eye, look_at, fov, [16; 2], GAUSSIAN)
        .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
        .depth(3)
}

#[test]
fn in_a_mirror() {
    let wall = parallelogram(vec3(-0.9, 0.9, -0.1), Vec3::X * 1.8, Vec3::Z * 1.6);
    let seen = mirrored(vec3(0.0, 0.9, 0.5), 14.0).solid("wall", wall, [0.5; 3]);
    let seen = seen.mirror("wall");
    for scene in thinned(2, [projector(seen.clone()), spot(seen)]) {
        checked(&scene, "bulb.position", &BULB_MOVED, 128, STEP);
        checked(&scene, "wall.rotation", &[0.1, 0.0, 0.2], 128, STEP);
    }
}

/// Chains from it bend along a line.
#[test]
fn spots_in_a_round_mirror() {
    let globe = ball(3, vec3(0.2, 0.9, 0.5), 0.5);
    let seen = mirrored(vec3(0.2, 0.5, 0.4), 9.0).smooth("globe", globe, [0.5; 3]);
    let scene = spot(seen.mirror("globe"));
    checked(&scene, "bulb.position", &BULB_MOVED, 256, STEP);
}

/// The wall sees the floor, on which the border moves.
#[test]
fn over_lobes() {
    let wall = parallelogram(vec3(-0.9, 0.7, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let at = vec3(0.0, 0.7, 0.5);
    let seen = scene(vec3(0.3, -3.4, 2.2), at, 8.0, [8; 2], GAUSSIAN)
        .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
        .solid("wall", wall, [0.8, 0.7, 0.6])
        .depth(3);
    for scene in thinned(2, [spot(seen.clone()), projector(seen.clone())]) {
        checked(&scene, "bulb.position", &BULB_MOVED, 512, Some(0.005));
    }
    let metal = projector(seen).metal("wall", 0.05, warpath::scene::Distribution::Ggx);
    checked(&metal, "bulb.position", &BULB_MOVED, 1024, Some(0.002));
}

#[test]
fn transposition() {
    let painted = "wall.bsdf.brdf_0.reflectance.value";
    let wall = parallelogram(vec3(-0.9, 0.5, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let scene = block_below()
        .solid("wall", wall, [0.5; 3])
        .depth(4)
        .mirror("wall");
    for scene in [projector(scene.clone()), spot(scene)] {
        transposed(&scene, Method::Reparam, &[painted]);
    }
}
