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

/// Smooth balls of glass and metal that show each other.
fn cluster() -> Scene {
    let ball_at = |scene: Scene, number: u8| {
        let id = format!("ball{number}");
        let [x, y, z] = [0.37, 0.71, 0.53].map(|step| (f32::from(number) * step).fract() - 0.5);
        let at = vec3(0.05, -0.65, 0.35) + vec3(0.7 * x, 0.5 * y, 0.4 * z);
        let scene = scene.smooth(&id, ball(2, at, 0.1), [0.5; 3]);
        match number % 2 {
            0 => scene.clear(&id),
            _ => scene.mirror(&id),
        }
    };
    (0..16).fold(room(12), ball_at)
}

/// Without relays single paths have most of the variance: with these random numbers 3 times that of
/// differences, and 0.16 times.
#[test]
fn long_chains_are_quiet() {
    let scene = cluster();
    let along = direction(&scene, &[("cam.translation", &MOVED)]);
    for seeds in [1..7, 200..206] {
        let of = |method| variance(&scene, (method, 64), &along, seeds.clone());
        let ratio = of(Method::Reparam) / of(Method::Fd);
        println!("{ratio}");
        assert!(ratio < 0.1, "{ratio}");
    }
}

#[test]
fn transposition() {
    let idle =
        ["glass", "metal", "lamp", "floor"].map(|id| format!("{id}.bsdf.brdf_0.reflectance.value"));
    let idle: Vec<&str> = idle.iter().map(String::as_str).collect();
    transposed(&small_balls(), Method::Reparam, &idle);
}
