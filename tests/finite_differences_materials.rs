//! As `finite_differences`: surfaces that are more than diffuse.

mod common;

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use warpath::scene::Distribution::{Beckmann, Ggx};
use warpath::scene::Scene;

const MOVED: (&str, &[f32]) = ("block.translation", &[1.0, 0.2, 0.1]);

fn moved(scene: &Scene, spp: u32, parts: &[(&str, &[f32])]) {
    check(scene, parts, spp, None, Fails);
}

#[test]
fn seen_in_a_narrow_reflection() {
    moved(
        &close_up().sky(SKY).depth(3).metal("floor", 0.1, Ggx),
        64,
        &[MOVED],
    );
}

#[test]
fn seen_in_a_wide_reflection() {
    moved(&room(3).metal("floor", 0.3, Beckmann), 128, &[MOVED]);
}

#[test]
fn lamp_seen_in_a_narrow_reflection() {
    let scene = shadow().metal("floor", 0.08, Ggx);
    moved(&scene, 64, &[("lamp.translation", &[1.0, 0.3, 0.2])]);
    moved(&scene, 64, &[MOVED]);
}

#[test]
fn lamp_seen_in_a_wide_reflection() {
    let scene = shadow().metal("floor", 0.3, Ggx);
    moved(&scene, 64, &[("lamp.translation", &[1.0, 0.3, 0.2])]);
    moved(&scene, 64, &[MOVED]);
}

#[test]
fn metal_that_moves() {
    let scene = close_up().sky(SKY).depth(3).metal("block", 0.1, Beckmann);
    moved(&scene, 64, &[("block.rotation", &[0.5, 0.3, 1.0])]);
    moved(&scene, 64, &[MOVED]);
}

#[test]
fn plastic_floor() {
    moved(&room(3).plastic("floor", Some(0.3)), 128, &[MOVED]);
    moved(&room(3).plastic("floor", Some(0.1)), 128, &[MOVED]);
}

#[test]
fn glass_that_moves() {
    let scene = close_up().sky(SKY).depth(5).glass("block", 0.1);
    moved(&scene, 128, &[MOVED]);
    moved(&scene, 128, &[("block.rotation", &[0.5, 0.3, 1.0])]);
}

#[test]
fn a_picture_that_moves() {
    let scene = close_up().sky(SKY).picture("floor");
    moved(&scene, 64, &[("floor.translation", &[1.0, 0.4, 0.1])]);
    moved(&scene, 64, &[("cam.translation", &[1.0, 0.4, 0.1])]);
}

#[test]
fn what_metal_is_made_of() {
    for alpha in [0.1, 0.3] {
        let scene = room(3).metal("floor", alpha, Ggx);
        for (key, by) in [
            ("floor.bsdf.alpha.value", [1.0].as_slice()),
            ("floor.bsdf.eta.value", &[1.0, 0.5, 0.2]),
            ("floor.bsdf.k.value", &[1.0, 0.5, 0.2]),
            ("floor.bsdf.specular_reflectance.value", &[1.0, 0.5, 0.2]),
        ] {
            check(&scene, &[(key, by)], 64, None, Agrees);
        }
    }
}

#[test]
fn what_plastic_is_made_of() {
    let scene = room(3).plastic("floor", Some(0.2));
    for (key, by) in [
        ("floor.bsdf.alpha", [1.0].as_slice()),
        ("floor.bsdf.diffuse_reflectance.value", &[1.0, 0.5, 0.2]),
        ("floor.bsdf.specular_reflectance.value", &[1.0, 0.5, 0.2]),
    ] {
        check(&scene, &[(key, by)], 64, None, Agrees);
    }
    let smooth = room(3).plastic("floor", None);
    let eta = [("floor.bsdf.eta", [1.0].as_slice())];
    check(&smooth, &eta, 64, None, Agrees);
}

#[test]
fn what_glass_is_made_of() {
    let scene = close_up().sky(SKY).depth(5).glass("block", 0.2);
    for (key, by) in [
        ("block.bsdf.alpha.value", [1.0].as_slice()),
        ("block.bsdf.specular_transmittance.value", &[1.0, 0.5, 0.2]),
    ] {
        check(&scene, &[(key, by)], 64, None, Agrees);
    }
    moved(&scene, 64, &[("block.bsdf.eta", &[1.0])]);
}

#[test]
fn what_a_picture_is_made_of() {
    let scene = room(3).picture("floor");
    let texels = [("floor.bsdf.reflectance.data", [1.0, 0.5, 0.2].as_slice())];
    check(&scene, &texels, 16, None, Agrees);
    let to_uv = [(
        "floor.bsdf.reflectance.to_uv",
        [0.3, 0.1, 0.5, -0.2, 0.4, 1.0].as_slice(),
    )];
    check(&scene, &to_uv, 64, None, Agrees);
}
