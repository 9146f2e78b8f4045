//! Sharp shadows that are seen in smooth surfaces or behind null ones and masks, and those that
//! fall on mixtures: against finite differences, and the other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{DeltaLightKind, Scene};

/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);
const MOVED: [f32; 3] = [1.0, 0.2, 0.1];

fn bulb(scene: Scene) -> Scene {
    let position = vec3(0.5, -0.3, 2.2);
    scene.delta_light("bulb", DeltaLightKind::Point { position }, [8.0, 7.0, 6.0])
}

fn sun(scene: Scene) -> Scene {
    let direction = vec3(-0.19, 0.13, -0.97);
    scene.delta_light(
        "sun",
        DeltaLightKind::Directional { direction },
        [2.0, 1.9, 1.7],
    )
}

fn checked(scene: &Scene, key: &str, by: &[f32], resolution: f64) {
    println!("{key}");
    check_to(resolution, scene, &[(key, by)], 128, STEP, Fails);
}

/// A mirror that stands behind a block on a floor; the camera sees the mirror alone.
fn seen_in_a_mirror() -> Scene {
    let wall = parallelogram(vec3(-0.9, 0.9, -0.1), Vec3::X * 1.8, Vec3::Z * 1.6);
    scene(
        vec3(0.3, -3.4, 2.2),
        vec3(0.0, 0.9, 0.5),
        14.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
    .solid("block", block(), [0.3, 0.6, 0.5])
    .solid("wall", wall, [0.5; 3])
    .depth(3)
    .mirror("wall")
}

#[test]
fn in_a_flat_mirror() {
    let lit = bulb(seen_in_a_mirror());
    let moved = [
        ("block.translation", MOVED),
        ("bulb.position", [1.0, 0.3, 0.6]),
        ("wall.rotation", [0.1, 0.0, 0.2]),
        ("cam.translation", MOVED),
    ];
    for (key, by) in thinned(2, moved) {
        checked(&lit, key, &by, 0.02);
    }
    checked(&sun(seen_in_a_mirror()), "block.translation", &MOVED, 0.02);
}

#[test]
fn in_a_curved_mirror_and_through_a_lens() {
    let mirror = bulb(behind_a_ball().mirror("ball"));
    checked(&mirror, "block.translation", &MOVED, 0.03);
    checked(&mirror, "ball.translation", &MOVED, 0.03);
    let lens = sun(behind_a_ball().clear("ball"));
    checked(&lens, "block.translation", &MOVED, 0.03);
    // Few paths hold what changes.
    let by_eta = [("ball.bsdf.eta", [1.0].as_slice())];
    check_to(0.03, &lens, &by_eta, 512, STEP, Fails);
}

#[test]
fn on_smooth_plastic() {
    let lit = bulb(close_up().plastic("floor", None).depth(3));
    checked(&lit, "block.translation", &MOVED, 0.02);
    checked(&lit, "bulb.position", &[1.0, 0.3, 0.6], 0.02);
}

#[test]
fn behind_null_surfaces_and_masks() {
    let veil = parallelogram(vec3(-0.9, -1.2, 0.3), Vec3::X * 1.7, Vec3::Z * 1.5);
    let veiled = || {
        close_up()
            .solid("veil", veil.clone(), [0.5, 0.2, 0.3])
            .depth(4)
    };
    let nothing = bulb(veiled().null("veil"));
    checked(&nothing, "block.translation", &MOVED, 0.02);
    let masked = || veiled().masked("veil", 0.4);
    let all = [
        (bulb(masked()), "veil.translation", 0.06),
        (bulb(masked()), "block.translation", 0.02),
        (sun(masked()), "cam.translation", 0.02),
    ];
    for (scene, key, resolution) in thinned(2, all) {
        checked(&scene, key, &MOVED, resolution);
    }
}

/// The shadow falls on what is half there, and on what is half of one material and half of another.
#[test]
fn on_masks_and_blends() {
    let masked = bulb(close_up().masked("floor", 0.6).depth(3));
    checked(&masked, "block.translation", &MOVED, 0.02);
    let blended = bulb(close_up().blended("floor", 0.3).depth(3));
    checked(&blended, "block.translation", &MOVED, 0.02);
    checked(&blended, "bulb.position", &[1.0, 0.3, 0.6], 0.02);
}

/// Where the film is small: larger steps are seen to bend.
const NEAR_STEP: Option<f64> = Some(0.005);

/// A rough wall sees the shadow in a mirror, or on a blend.
#[test]
fn over_lobes() {
    let wall = parallelogram(vec3(-0.9, 0.9, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let room = |s: Scene| bulb(s.solid("wall", wall.clone(), [0.8, 0.7, 0.6])).depth(4);
    let at = vec3(0.0, 0.9, 0.5);
    let view = || {
        let side = parallelogram(vec3(-1.2, -0.8, 0.0), Vec3::Y * 1.6, Vec3::Z * 1.6);
        scene(vec3(0.3, -3.4, 2.2), at, 8.0, [8; 2], GAUSSIAN)
            .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
            .solid("block", block(), [0.3, 0.6, 0.5])
            .solid("side", side, [0.5; 3])
    };
    let blended = || room(view().blended("floor", 0.3));
    let mirrored = || room(view().mirror("side"));
    let all = [
        (blended(), "block.translation", MOVED),
        (mirrored(), "block.translation", MOVED),
        (mirrored(), "bulb.position", [1.0, 0.3, 0.6]),
    ];
    for (scene, key, by) in thinned(2, all) {
        check_to(0.04, &scene, &[(key, &by)], 1024, NEAR_STEP, Fails);
    }
}

#[test]
fn transposition() {
    let painted = "wall.bsdf.brdf_0.reflectance.value";
    transposed(&bulb(seen_in_a_mirror()), Method::Reparam, &[painted]);
    let masked = sun(bulb(close_up().masked("floor", 0.6).depth(3)));
    transposed(&masked, Method::Reparam, &[]);
}
