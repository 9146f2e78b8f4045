//! What is seen in smooth surfaces and behind holes that are parts of mixtures, against finite
//! differences, and the other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Scene;

const MOVED: [f32; 3] = [1.0, 0.0, 0.2];
/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);

fn checked(scene: &Scene, spp: u32, key: &str, resolution: f64) {
    println!("{key}");
    check_to(resolution, scene, &[(key, &MOVED)], spp, STEP, Fails);
}

/// A black plate before a sheet, another behind it, and the sky.
fn before_and_behind() -> Scene {
    let behind = parallelogram(vec3(-0.7, 1.0, -0.4), Vec3::X * 0.9, Vec3::Z * 0.9);
    let sheet = parallelogram(vec3(-0.6, 0.2, -0.6), Vec3::X * 1.2, Vec3::Z * 1.2);
    let before = parallelogram(vec3(0.0, -1.1, -0.9), Vec3::X * 0.5, Vec3::Z * 0.5);
    scene(
        vec3(0.3, -3.4, 0.9),
        vec3(0.0, 0.2, 0.0),
        22.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("sheet", sheet, [0.2, 0.3, 0.1])
    .solid("behind", behind, [0.0; 3])
    .solid("before", before, [0.0; 3])
    .constant_environment(SKY)
    .depth(2)
}

#[test]
fn in_a_mirror_with_holes() {
    let scene = before_and_behind().mirror("sheet").masked("sheet", 0.6);
    checked(&scene, 256, "before.translation", 0.03);
    checked(&scene, 256, "behind.translation", 0.03);
    checked(&scene, 256, "sheet.rotation", 0.03);
    checked(&scene, 256, "cam.translation", 0.03);
}

#[test]
fn in_a_blend_of_glass_and_paint() {
    let scene = before_and_behind().depth(4).clear("sheet");
    let scene = scene.blended("sheet", 0.7);
    for (key, resolution) in thinned(2, [("before.translation", 0.04), ("cam.translation", 0.03)]) {
        checked(&scene, 512, key, resolution);
    }
}

#[test]
fn behind_a_mask_of_a_mask() {
    let scene = before_and_behind().masked("sheet", 0.4);
    let scene = scene.masked("sheet", 0.7);
    checked(&scene, 256, "behind.translation", 0.03);
    checked(&scene, 256, "sheet.translation", 0.03);
}

/// A wall sees a plate through holes in a mirror along its lobes.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn over_lobes() {
    let wall = parallelogram(vec3(-0.9, 0.7, 0.0), Vec3::X * 1.8, Vec3::Z * 1.6);
    let sheet = parallelogram(vec3(-0.4, -0.5, 0.3), Vec3::X * 0.8, Vec3::Y * 0.8);
    let below = parallelogram(vec3(-0.3, -0.4, 0.1), Vec3::X * 0.6, Vec3::Y * 0.6);
    let at = vec3(0.0, 0.7, 0.5);
    let seen = scene(vec3(0.3, -3.4, 2.2), at, 8.0, [8; 2], GAUSSIAN)
        .solid("wall", wall, [0.8, 0.7, 0.6])
        .solid("sheet", sheet, [0.5; 3])
        .solid("below", below, [0.0; 3])
        .constant_environment(SKY)
        .depth(3);
    let scene = seen.mirror("sheet").masked("sheet", 0.4);
    // What a wall sees of it is blurred: wide steps are as right.
    let along = [("below.translation", &MOVED[..])];
    check_to(0.05, &scene, &along, 2048, Some(0.05), Fails);
}

/// Of glass with holes the index of refraction moves what is seen through it.
#[test]
fn transposition() {
    let painted = "sheet.bsdf.brdf_0.reflectance.value";
    let scene = before_and_behind().depth(4);
    for scene in [scene.clone().clear("sheet"), scene.mirror("sheet")] {
        transposed(&scene.masked("sheet", 0.6), Method::Reparam, &[painted]);
    }
}
