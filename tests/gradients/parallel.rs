//! Cameras whose rays are parallel: against a closed form, finite differences, and the other sweep.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use common::{Direction, direction, gradient, loses_nothing, settings, variance};
use glam::{Vec2, Vec3, vec2, vec3};
use warpath::methods::Method;
use warpath::scene::{DeltaLightKind, Lens, Scene};

/// Half the width and, of a square film, half the height, in units of the world. Of the second a
/// pixel is 0.1 by 0.08, so that rims of the lamp lie between lines of samples.
const EVEN: Vec2 = Vec2::splat(1.2);
const UNEVEN: Vec2 = vec2(1.2, 0.96);
/// World units: about a tenth of a pixel.
const STEP: Option<f64> = Some(0.012);

fn seen_in_parallel(mut scene: Scene, half_sides: Vec2) -> Scene {
    scene.sensors[0].lens = Lens::Parallel { half_sides };
    scene
}

/// A lamp before nothing, as it is.
fn lamp([x, z]: [f32; 2], half_sides: Vec2) -> Scene {
    let lamp = parallelogram(vec3(-x, 0.5, -z), Vec3::X * 2.0 * x, Vec3::Z * 2.0 * z);
    let eye = vec3(0.0, -3.0, 0.0);
    seen_in_parallel(scene(eye, Vec3::ZERO, 30.0, [24; 2], BOX), half_sides)
        .depth(1)
        .light("lamp", lamp, [3.0, 2.0, 1.0])
}

/// What the left half of the film loses to the right one as a lamp moves to the right, per unit of
/// motion: a strip of the lamp's height, in pixels, of its radiance. Lifted, the upper half gains
/// one of its width. As the film comes nearer, nothing changes.
#[test]
fn edges_move_as_they_are() {
    edges_move(EVEN);
    edges_move(UNEVEN);
}

fn edges_move(half_sides: Vec2) {
    let [width, height] = [0.7, 0.5];
    let scene = lamp([width, height], half_sides);
    let per_area = 12.0 * 12.0 / f64::from(half_sides.x * half_sides.y);
    let settings = settings(&scene, Method::Reparam, 64, 1);
    let sums = |key: &str, by: [f32; 3], counts: &dyn Fn(usize, usize) -> bool| {
        let along = direction(&scene, &[(key, &by)]);
        let image = gradient(&scene, &settings, &along);
        let red = image.iter().step_by(3).enumerate();
        let of_half = red.filter(|(i, _)| counts(i % 24, i / 24)).map(|(_, g)| g);
        of_half.sum::<f64>()
    };
    let across = 2.0 * f64::from(height) * per_area * 3.0;
    let along = 2.0 * f64::from(width) * per_area * 3.0;
    let left = |x: usize, _: usize| x < 12;
    let upper = |_: usize, y: usize| y < 12;
    let moved = sums("lamp.translation", [1.0, 0.0, 0.0], &left);
    let lifted = sums("lamp.translation", [0.0, 0.0, 1.0], &upper);
    let followed = sums("cam.translation", [1.0, 0.0, 0.0], &left);
    let nearer = sums("cam.translation", [0.0, 1.0, 0.0], &left);
    println!("{moved} {lifted} {followed} {nearer}, {across} {along}");
    // Single precision, in which images are.
    let is_near = |a: f64, b: f64| (a - b).abs() < 1e-5 * along;
    assert!(is_near(moved, -across) && is_near(lifted, along));
    assert!(is_near(followed, -moved) && is_near(nearer, 0.0));
}

fn table(half_sides: Vec2) -> Scene {
    let scene = seen_in_parallel(lit(floor_seen(16, GAUSSIAN)), half_sides);
    scene.solid("block", block(), [0.3, 0.6, 0.5])
}

fn checked(scene: &Scene, key: &str, by: &[f32], step: Option<f64>) {
    println!("{key}");
    check_to(0.03, scene, &[(key, by)], 128, step, Fails);
}

#[test]
fn what_is_seen_moves() {
    checked(&table(EVEN), "block.translation", &[1.0, 0.2, 0.3], STEP);
    checked(&table(EVEN), "block.rotation", &[0.5, 0.3, 1.0], STEP);
    checked(&table(UNEVEN), "block.translation", &[1.0, 0.2, 0.3], STEP);
}

#[test]
fn the_camera_moves_and_turns() {
    checked(&table(EVEN), "cam.translation", &[1.0, 0.4, 0.2], STEP);
    checked(&table(EVEN), "cam.rotation", &[0.2, 0.3, 1.0], Some(0.003));
    checked(
        &table(UNEVEN),
        "cam.rotation",
        &[0.2, 0.3, 1.0],
        Some(0.003),
    );
}

#[test]
fn sharp_shadows_move() {
    let bulb = DeltaLightKind::Point {
        position: vec3(0.5, 0.3, 2.2),
    };
    let scene = seen_in_parallel(floor_seen(16, GAUSSIAN), EVEN)
        .solid("block", block(), [0.3, 0.6, 0.5])
        .delta_light("bulb", bulb, [8.0, 7.0, 6.0]);
    checked(&scene, "block.translation", &[1.0, 0.2, 0.1], STEP);
}

fn mirror(half_sides: Vec2) -> Scene {
    let shape = ball(3, vec3(-0.2, -0.2, 0.4), 0.35);
    table(half_sides)
        .depth(4)
        .smooth("ball", shape, [0.5; 3])
        .mirror("ball")
}

#[test]
fn what_mirrors_show_moves() {
    checked(&mirror(EVEN), "block.translation", &[1.0, 0.2, 0.3], STEP);
}

#[test]
fn little_is_lost() {
    let lose = |scene: &Scene, key, by: &[f32]| {
        let settings = settings(scene, Method::Reparam, 64, 2);
        let along: Direction = direction(scene, &[(key, by)]);
        loses_nothing(scene, &settings, &along);
    };
    lose(&table(EVEN), "block.translation", &[1.0, 0.2, 0.3]);
    lose(&table(UNEVEN), "cam.rotation", &[0.2, 0.3, 1.0]);
}

/// Colours have no edges.
#[test]
fn colours_change() {
    let paint = [(
        "block.bsdf.brdf_0.reflectance.value",
        [1.0, 0.5, 0.2].as_slice(),
    )];
    check_to(0.03, &table(EVEN), &paint, 128, None, Agrees);
}

#[test]
fn transposition() {
    let idle = ["ball.bsdf.brdf_0.reflectance.value"];
    transposed(&mirror(UNEVEN), Method::Reparam, &idle);
}

/// Differences have less noise with samples that are carried along.
#[test]
fn samples_are_carried() {
    let scene = table(EVEN);
    let along = direction(&scene, &[("cam.translation", &[1.0, 0.4, 0.2])]);
    let [rest, carried] =
        [Method::Fd, Method::CarriedFd].map(|method| variance(&scene, (method, 64), &along, 0..8));
    println!("{}", rest / carried);
    assert!(rest > 2.0 * carried);
}
