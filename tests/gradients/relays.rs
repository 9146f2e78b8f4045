//! Vertices that move fast, which paths are compared at over a step (`paths::relay`).

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::*;
use common::scenes::*;
use common::transposition::transposed;
use common::{Quiet, direction, settings, variance};
use glam::vec3;
use warpath::methods::{Method, forward};
use warpath::scene::{DeltaLightKind, Distribution, Scene};

const MOVED: [f32; 3] = [1.0, 0.2, 0.4];

/// Small balls of glass and metal above a floor that shines a little, before a wall.
fn small_balls() -> Scene {
    room(5)
        .smooth("glass", ball(3, vec3(-0.45, -0.5, 0.3), 0.1), [0.5; 3])
        .smooth("metal", ball(3, vec3(0.4, -0.6, 0.35), 0.07), [0.5; 3])
        .clear("glass")
        .metal("metal", 0.05, Distribution::Ggx)
        .plastic("floor", Some(0.05))
}

/// Rays that are traced because vertices move fast.
fn relayed(scene: &Scene, key: &str) -> u64 {
    let along = direction(scene, &[(key, &MOVED)]);
    let settings = settings(scene, Method::Reparam, 64, 1);
    let done = forward(scene, &settings, &along, &Quiet).expect("a gradient image");
    done.statistics.rays.get("relay").copied().unwrap_or(0)
}

fn check_relayed(scene: &Scene, key: &str) {
    assert!(relayed(scene, key) > 100, "{key}");
    println!("{key}");
    check_to(0.02, scene, &[(key, &MOVED)], 1024, Some(0.003), Fails);
}

#[test]
fn what_small_balls_show_is_right() {
    let scene = small_balls();
    check_relayed(&scene, "cam.translation");
    check_relayed(&scene, "block.translation");
}

/// These are borders before a relay, and no part of its differences.
#[test]
fn what_jumps_over_a_relay_is_found_once() {
    let light = DeltaLightKind::Point {
        position: vec3(-0.6, -0.9, 1.6),
    };
    let scene = small_balls()
        .delta_light("bulb", light, [9.0, 8.0, 7.0])
        .checkerboard("wall");
    check_relayed(&scene, "cam.translation");
    check_relayed(&scene, "block.translation");
}

/// Where nothing moves that a path has met nothing is compared.
#[test]
fn what_rests_has_none() {
    assert_eq!(relayed(&small_balls(), "lamp.translation"), 0);
}

/// Without them single paths have most of the variance.
#[test]
fn small_balls_are_quiet() {
    let scene = small_balls();
    let along = direction(&scene, &[("cam.translation", &MOVED)]);
    for first in [1, 100, 200] {
        let of = |method| variance(&scene, (method, 64), &along, first..first + 12);
        let ratio = of(Method::Reparam) / of(Method::Fd);
        println!("{ratio}");
        assert!(ratio < 0.5, "{ratio}");
    }
}

#[test]
fn transposition() {
    let idle =
        ["glass", "metal", "lamp", "floor"].map(|id| format!("{id}.bsdf.brdf_0.reflectance.value"));
    let idle: Vec<&str> = idle.iter().map(String::as_str).collect();
    transposed(&small_balls(), Method::Reparam, &idle);
}
