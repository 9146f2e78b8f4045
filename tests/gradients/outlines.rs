//! The noise that outlines have of their own: facets that are seen edge-on, and the jumps beside an
//! outline, which are fewer than samples.

use common::comparison::{Interior::Fails, check};
use common::scenes::*;
use common::{direction, variance};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Scene;

const MOVED: [(&str, &[f32]); 1] = [("ball.translation", &[1.0, 0.3, 0.2])];

/// A ball before a wall, under an even sky that both see one time in a few.
fn before_a_wall() -> Scene {
    let from = vec3(0.3, -5.0, 1.2);
    let wall = parallelogram(vec3(-4.0, 3.0, -4.0), Vec3::X * 8.0, Vec3::Z * 8.0);
    scene(from, Vec3::ZERO, 26.0, [12; 2], GAUSSIAN)
        .depth(2)
        .smooth("ball", ball(3, Vec3::ZERO, 0.8), [0.25, 0.4, 0.6])
        .solid("wall", wall, [0.7, 0.5, 0.3])
        .constant_environment([1.0; 3])
}

/// Differences have 3.7 times its variance.
#[test]
fn noise_is_small() {
    let scene = before_a_wall();
    let along = direction(&scene, &MOVED);
    let [ours, differences] =
        [Method::Reparam, Method::CarriedFd].map(|m| variance(&scene, (m, 64), &along, 0..24));
    println!("{ours} {differences} {}", differences / ours);
    assert!(differences > 2.5 * ours, "{ours} {differences}");
}

/// Seen from near, where facets cross tiles and the film's rim.
#[test]
fn a_part_of_an_outline() {
    let at = vec3(0.7, 0.0, 0.35);
    let mut near = scene(vec3(0.3, -5.0, 1.2), at, 4.0, [12; 2], GAUSSIAN);
    let far = before_a_wall();
    let sensors = std::mem::take(&mut near.sensors);
    let near = Scene { sensors, ..far };
    check(&near, &MOVED, 256, None, Fails);
}
