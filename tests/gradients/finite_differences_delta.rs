//! Sharp shadows: those of delta lights, whatever moves, against finite differences.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::{Quiet, direction, flat, settings};
use glam::vec3;
use warpath::methods::{Method, forward};
use warpath::scene::Distribution::Ggx;
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
    // Differences are noisy.
    check_to(0.03, &sun(shadow()), &turned, 128, Some(0.01), Fails);
}

#[test]
fn the_light_moves() {
    holds(&bulb(shadow()), &[("bulb.position", &[1.0, 0.3, 0.6])]);
}

/// How fast a tangent says that the light moves does not matter: the steps are as far.
#[test]
fn differences_step_by_pixels() {
    let scene = bulb(shadow());
    let by = |times: f32| {
        let along = direction(
            &scene,
            &[("bulb.position", &[times, 0.25 * times, 0.5 * times])],
        );
        flat(
            &forward(&scene, &settings(&scene, Method::Fd, 4, 3), &along, &Quiet)
                .unwrap()
                .gradient,
        )
    };
    let (slow, fast) = (by(1.0), by(1024.0));
    assert!(slow.iter().any(|g| *g != 0.0));
    assert!(
        slow.iter()
            .zip(&fast)
            .all(|(slow, fast)| 1024.0 * slow == *fast)
    );
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

/// Shadows on what is curved, smooth and flat-shaded, of other things and of its own parts.
#[test]
fn shadows_on_curved_surfaces() {
    let on = |scene: Scene| scene.solid("block", block(), [0.3, 0.6, 0.5]);
    let hill = || ball(2, vec3(0.0, 0.0, -0.5), 0.8);
    let seen = || {
        scene(
            vec3(0.3, -3.4, 1.9),
            vec3(0.0, 0.0, 0.1),
            30.0,
            [16; 2],
            GAUSSIAN,
        )
    };
    let moved = [
        ("block.translation", [1.0, 0.2, 0.1].as_slice()),
        ("hill.translation", &[0.2, 0.1, 0.6]),
    ];
    let smooth = on(seen().smooth("hill", hill(), [0.6, 0.5, 0.4]));
    holds(&bulb(smooth.clone()), &moved);
    holds(&sun(smooth), &moved);
    let flat = on(seen().solid("hill", hill(), [0.6, 0.5, 0.4]));
    holds(&bulb(flat), &moved);
}

/// Many shadows beside one another, thrown by a body on itself and on the floor.
#[test]
fn shadows_of_spikes() {
    let star = spiky(vec3(0.1, 0.0, 0.5), 0.35, [1.4, 0.7]);
    let scene = floor_seen(20, GAUSSIAN).solid("star", star, [0.75; 3]);
    let moved = [("star.translation", [1.0, 0.0, 0.2].as_slice())];
    check(&bulb(scene.clone()), &moved, 256, Some(0.003), Fails);
    check(&sun(scene), &moved, 256, Some(0.003), Fails);
}

/// Two bulbs and the sun, under a sky with a sun of its own and a lamp.
#[test]
fn many_lights() {
    let other = DeltaLightKind::Point {
        position: vec3(-0.9, -0.4, 1.4),
    };
    let two = bulb(sun(shadow())).delta_light("other", other, [2.0, 3.0, 3.0]);
    let moved = [
        ("block.translation", [1.0, 0.2, 0.1].as_slice()),
        ("other.position", &[0.3, 0.1, 0.2]),
    ];
    holds(&two, &moved);
    holds(&lit(two).sunny(), &moved);
}

/// What is lit by light that a shadow lets pass: its colour bleeds on the floor.
#[test]
fn shadows_seen_by_diffuse_surfaces() {
    let wall = parallelogram(
        vec3(-0.9, 0.9, -0.1),
        vec3(1.8, 0.0, 0.0),
        vec3(0.0, 0.0, 1.6),
    );
    let room = bulb(close_up())
        .solid("wall", wall, [0.8, 0.2, 0.1])
        .depth(4);
    let moved = [("block.translation", [1.0, 0.2, 0.1].as_slice())];
    check(&room, &moved, 512, Some(0.01), Fails);
    let moved = [
        ("bulb.position", [1.0, 0.3, 0.6].as_slice()),
        ("cam.translation", &[0.3, 0.1, 0.4]),
    ];
    check(&room, &moved, 512, Some(0.01), Fails);
}

/// The first light that arrives comes from a floor out of sight, on which the shadow moves.
#[test]
fn shadows_out_of_sight() {
    let wall = parallelogram(
        vec3(-0.9, 0.5, 0.0),
        vec3(1.8, 0.0, 0.0),
        vec3(0.0, 0.0, 1.6),
    );
    let view = |scene: Scene| {
        scene
            .solid("floor", floor(1.2, 0.0), [0.6, 0.5, 0.4])
            .solid("block", block(), [0.3, 0.6, 0.5])
            .depth(3)
    };
    let at = vec3(0.0, 0.5, 0.4);
    let seen = || scene(vec3(0.3, -3.4, 1.2), at, 8.0, [8; 2], GAUSSIAN);
    let moved = [("block.translation", [1.0, 0.2, 0.1].as_slice())];
    let diffuse = view(seen().solid("wall", wall.clone(), [0.8, 0.7, 0.6]));
    check_to(
        0.04,
        &bulb(diffuse.clone()),
        &moved,
        1024,
        Some(0.02),
        Fails,
    );
    let mirror = diffuse.metal("wall", 0.05, Ggx);
    check_to(0.04, &bulb(mirror.clone()), &moved, 1024, Some(0.02), Fails);
    check_to(0.04, &sun(mirror), &moved, 1024, Some(0.02), Fails);
}

/// A coarse ball with shading normals: where it turns away from the light its triangles are dark
/// one by one, though shading goes on.
#[test]
fn where_a_smooth_surface_turns_away() {
    let across = DeltaLightKind::Directional {
        direction: vec3(-0.9, 0.3, -0.2).normalize(),
    };
    let seen = scene(
        vec3(0.3, -3.4, 0.4),
        vec3(0.0, 0.0, 0.0),
        16.0,
        [16; 2],
        GAUSSIAN,
    )
    .smooth("ball", ball(1, vec3(0.0, 0.0, 0.0), 0.9), [0.6, 0.5, 0.4])
    .delta_light("sun", across, [2.0, 1.9, 1.7]);
    holds(&seen, &[("ball.translation", &[1.0, 0.2, 0.5])]);
    holds(&seen, &[("cam.rotation", &[0.1, 0.2, 0.3])]);
}
