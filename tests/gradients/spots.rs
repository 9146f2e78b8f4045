//! Spots without a ramp: the border of their light, wherever it is seen, against finite differences,
//! and the other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Mat3, Vec3, vec3};
use std::f32::consts::PI;
use warpath::methods::Method;
use warpath::scene::{Beam, BeamProfile, DeltaLightKind, Scene};

/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);
const MOVED: [f32; 3] = [1.0, 0.2, 0.1];

/// As bright at its cutoff as within, from above, askew.
fn lit(scene: Scene) -> Scene {
    let position = vec3(0.2, -0.1, 2.4);
    let kind = DeltaLightKind::Point { position };
    let mut scene = scene.delta_light("bulb", kind, [4.0, 3.0, 2.0]);
    let light = scene.delta_lights.last_mut().expect("a light");
    light.beam = Some(Beam {
        // Of a beam that is wider one way than the other.
        to_local: Mat3::from_diagonal(vec3(0.8, 1.0, 1.1)) * Mat3::from_rotation_x(PI - 0.15),
        profile: BeamProfile::Spot {
            beam_width_rad: 0.21,
            cutoff_rad: 0.21,
            texture: None,
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
    let scene = lit(block_below());
    // Wider differences are off where the border crosses the block's edges.
    checked(&scene, "bulb.position", &[1.0, 0.3, 0.6], 1024, Some(0.003));
    checked(&scene, "block.translation", &MOVED, 128, STEP);
    checked(&scene, "cam.translation", &MOVED, 128, STEP);
}

/// Chains from a mirror that is not flat bend along a line.
#[test]
fn in_mirrors() {
    let wall = parallelogram(vec3(-0.9, 0.9, -0.1), Vec3::X * 1.8, Vec3::Z * 1.6);
    let seen = |look_at: Vec3, fov| {
        let eye = vec3(0.3, -3.4, 2.2);
        scene(eye, look_at, fov, [16; 2], GAUSSIAN)
            .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
            .depth(3)
    };
    let flat = seen(vec3(0.0, 0.9, 0.5), 14.0).solid("wall", wall, [0.5; 3]);
    let flat = lit(flat.mirror("wall"));
    checked(&flat, "bulb.position", &[1.0, 0.3, 0.6], 128, STEP);
    checked(&flat, "wall.rotation", &[0.1, 0.0, 0.2], 128, STEP);
    let globe = ball(3, vec3(0.2, 0.9, 0.5), 0.5);
    let round = seen(vec3(0.2, 0.5, 0.4), 9.0).smooth("globe", globe, [0.5; 3]);
    let round = lit(round.mirror("globe"));
    checked(&round, "bulb.position", &[1.0, 0.3, 0.6], 256, STEP);
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
    let scene = lit(seen);
    checked(&scene, "bulb.position", &[1.0, 0.3, 0.6], 512, Some(0.005));
}

#[test]
fn transposition() {
    let painted = "wall.bsdf.brdf_0.reflectance.value";
    let wall = parallelogram(vec3(-0.9, 0.5, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let scene = block_below()
        .solid("wall", wall, [0.5; 3])
        .depth(4)
        .mirror("wall");
    transposed(&lit(scene), Method::Reparam, &[painted]);
}
