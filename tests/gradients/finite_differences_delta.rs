//! Sharp shadows: those of delta lights, whatever moves, against finite differences.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::scenes::*;
use glam::vec3;
use warpath::scene::{DeltaLightKind, Scene};

const POINT: DeltaLightKind = DeltaLightKind::Point {
    position: vec3(0.5, 0.3, 2.2),
};
const DOWN: DeltaLightKind = DeltaLightKind::Directional {
    direction: vec3(-0.19, 0.13, -0.97),
};

fn bulb(scene: Scene) -> Scene {
    scene.delta_light("bulb", POINT, [8.0, 7.0, 6.0])
}

fn sun(scene: Scene) -> Scene {
    scene.delta_light("sun", DOWN, [2.0, 1.9, 1.7])
}

/// A block above a floor.
fn shadow() -> Scene {
    floor_seen(20, GAUSSIAN).solid("block", block(), [0.3, 0.6, 0.5])
}

fn holds(scene: &Scene, parts: &[(&str, &[f32])]) {
    check(scene, parts, 128, Some(0.01), Fails);
}

#[test]
fn what_throws_the_shadow_is_translated() {
    let moved = [("block.translation", [1.0, 0.2, 0.1].as_slice())];
    holds(&bulb(shadow()), &moved);
    holds(&sun(shadow()), &moved);
}

#[test]
fn what_throws_the_shadow_is_rotated() {
    let turned = [("block.rotation", [0.5, 0.3, 1.0].as_slice())];
    holds(&bulb(shadow()), &turned);
    holds(&sun(shadow()), &turned);
}

#[test]
fn the_light_moves() {
    holds(&bulb(shadow()), &[("bulb.position", &[1.0, 0.3, 0.6])]);
}

#[test]
fn what_the_shadow_falls_on_moves() {
    let moved = [
        ("floor.translation", [0.2, 0.1, 1.0].as_slice()),
        ("floor.rotation", &[0.2, 0.3, 0.1]),
    ];
    holds(&bulb(shadow()), &moved);
    holds(&sun(shadow()), &moved);
}

#[test]
fn the_camera_moves() {
    let moved = [
        ("cam.translation", [0.3, 0.1, 1.0].as_slice()),
        ("cam.rotation", &[0.1, 0.2, 0.3]),
    ];
    holds(&bulb(shadow()), &moved);
    holds(&sun(shadow()), &moved);
}
