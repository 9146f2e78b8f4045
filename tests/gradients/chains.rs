//! What is seen through smooth surfaces: against the scene unfolded, finite differences, and the
//! other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::Shape;
use common::statistics::Agreement;
use common::transposition::transposed;
use common::{Quiet, direction, gradient, settings};
use glam::{Vec3, vec3};
use std::f32::consts::{PI, TAU};
use warpath::methods::{Method, forward};
use warpath::scene::Scene;

const MOVED: [f32; 3] = [1.0, 0.0, 0.2];
/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);

fn checked(scene: &Scene, spp: u32, key: &str, by: &[f32], resolution: f64) {
    println!("{key}");
    let parts = [(key, by)];
    check_to(resolution, scene, &parts, spp, STEP, Fails);
}

const CORNER: Vec3 = vec3(-0.3, 1.9, 1.1);

/// A black plate before the sky that the camera sees in the floor alone.
pub fn over_a_mirror() -> Scene {
    let plate = parallelogram(CORNER, Vec3::X * 0.8, Vec3::Z * 0.7);
    let scene = small_floor()
        .solid("plate", plate, [0.0; 3])
        .constant_environment(SKY);
    scene.depth(2).mirror("floor")
}

#[test]
fn an_edge_in_a_flat_mirror() {
    let scene = over_a_mirror();
    checked(&scene, 256, "plate.translation", &MOVED, 0.02);
    checked(&scene, 256, "floor.rotation", &[0.5, 0.3, 0.0], 0.01);
    checked(&scene, 256, "cam.translation", &MOVED, 0.01);
}

/// A mirror loses no light.
pub fn lossless(mut scene: Scene, mirror: &str) -> Scene {
    for (key, value) in [("eta", 0.0), ("k", 1.0), ("specular_reflectance", 1.0)] {
        let key = format!("{mirror}.bsdf.{key}");
        let texture = scene.textures.iter_mut().find(|t| t.key == key);
        texture.expect("a texture").texels = vec![[value; 3]];
    }
    scene
}

/// An edge in a flat mirror that loses no light is one behind it, where the mirror is a window.
#[test]
fn a_flat_mirror_is_a_window() {
    let folded = lossless(over_a_mirror(), "floor");
    let mut unfolded = small_floor();
    unfolded.meshes.clear();
    let behind = vec3(CORNER.x, CORNER.y, -CORNER.z);
    let plate = parallelogram(behind, Vec3::X * 0.8, Vec3::Z * -0.7);
    let unfolded = unfolded
        .solid("plate", plate, [0.0; 3])
        .constant_environment(SKY)
        .depth(2);
    let runs = |scene: &Scene, by: [f32; 3], first: u64| -> Vec<Vec<f64>> {
        let along = direction(scene, &[("plate.translation", &by)]);
        let one = |seed| gradient(scene, &settings(scene, Method::Reparam, 256, seed), &along);
        (first..first + 12).map(one).collect()
    };
    let [x, y, z] = MOVED;
    let ours = Agreement::new(&runs(&folded, MOVED, 1), &runs(&unfolded, [x, y, -z], 1000));
    println!("{ours:.4?}");
    assert!(ours.bias.error < 0.005, "{ours:.4?}");
    assert!(ours.holds(4.0), "{ours:.4?}");
}

/// A ball of metal or glass between plates before the sky.
pub fn ball_before_a_plate() -> Scene {
    let plate = parallelogram(vec3(-0.7, 1.0, -0.4), Vec3::X * 0.9, Vec3::Z * 0.9);
    let near = parallelogram(vec3(-1.0, -2.0, -0.1), Vec3::X * 0.8, Vec3::Z * 0.9);
    scene(
        vec3(0.3, -3.4, 0.9),
        vec3(0.0, 0.0, 0.0),
        22.0,
        [16; 2],
        GAUSSIAN,
    )
    .smooth("ball", ball(3, Vec3::ZERO, 0.5), [0.5; 3])
    .solid("plate", plate, [0.0; 3])
    .solid("near", near, [0.0; 3])
    .constant_environment(SKY)
}

#[test]
fn an_edge_in_a_curved_mirror() {
    let scene = ball_before_a_plate().depth(2).mirror("ball");
    checked(&scene, 256, "near.translation", &MOVED, 0.03);
    checked(&scene, 256, "ball.translation", &MOVED, 0.01);
}

/// A ball of few long triangles, dented.
fn dented_ball() -> Shape {
    const ROWS: u32 = 4;
    const COLUMNS: u32 = 11;
    let at = |row: u32, column: u32| {
        let angles = [
            row as f32 / ROWS as f32 * PI,
            column as f32 / COLUMNS as f32 * TAU,
        ];
        let [(sine, z), (y, x)] = angles.map(f32::sin_cos);
        let n = vec3(sine * x, sine * y, z);
        let waves = [
            vec3(-0.534, -0.628, -1.654),
            vec3(0.466, -1.888, -0.82),
            vec3(-1.913, 2.3, 0.911),
        ];
        let dents: f32 = waves.iter().map(|wave| n.dot(*wave).sin()).sum();
        n * vec3(0.242, 0.22, 0.191) * (1.0 + 0.076 * dents)
    };
    let ring = |row| (0..COLUMNS).map(move |column| (row, column));
    let rings = (1..ROWS).flat_map(ring).chain([(0, 0), (ROWS, 0)]);
    let [top, bottom] = [0, 1].map(|pole| (ROWS - 1) * COLUMNS + pole);
    let quad = |(row, column): (u32, u32)| {
        let next = (column + 1) % COLUMNS;
        let of = |row: u32, column: u32| match row {
            0 => top,
            ROWS => bottom,
            _ => (row - 1) * COLUMNS + column,
        };
        let (a, b) = ([row, row + 1, row + 1], [row, row + 1, row]);
        let first = [of(a[0], column), of(a[1], column), of(a[2], next)];
        let second = [of(b[0], column), of(b[1], next), of(b[2], next)];
        let is_whole = |t: &[u32; 3]| t[0] != t[1] && t[1] != t[2] && t[2] != t[0];
        [first, second].into_iter().filter(is_whole)
    };
    let triangles = (0..ROWS).flat_map(ring).flat_map(quad).collect();
    (
        rings.map(|(row, column)| at(row, column)).collect(),
        triangles,
    )
}

/// A ball of metal before an even sky that it shows in full: only bands are seen, where its shading
/// normals send rays below the planes of triangles.
#[test]
fn bands_of_a_coarse_ball() {
    let eye = vec3(0.28, -3.2, 1.723);
    let target = vec3(-0.136, 0.0, 0.217);
    let ball = placed(dented_ball(), Vec3::X * 2.857, Vec3::ZERO);
    let ball = placed(ball, Vec3::Z * 290.017, vec3(-0.485, -0.436, 0.852));
    let scene = scene(eye, target, 31.92, [52, 44], BOX)
        .constant_environment(SKY)
        .smooth("ball", ball, [0.5; 3])
        .mirror("ball");
    let scene = lossless(scene.depth(3), "ball");
    // Bands are thinner than a pixel.
    let parts = [("ball.translation", [1.0, 0.3, 0.5].as_slice())];
    check_to(0.04, &scene, &parts, 128, Some(0.003), Fails);
}

/// How many cells a gradient image had and how many of them found nothing, as a plate moves.
fn found_and_lost(scene: &Scene, plate: &str) -> [u64; 2] {
    let along = direction(scene, &[(plate, &MOVED)]);
    let settings = settings(scene, Method::Reparam, 64, 3);
    let image = forward(scene, &settings, &along, &Quiet).expect("a gradient image");
    let all = image.statistics.borders.all();
    [all.found, all.lost]
}

/// Two mirrors that pass through each other over a floor, and a plate before them. From the floor
/// one of them is seen in gaps that no point of a line need lie in.
#[test]
fn mirrors_that_cross() {
    let left = parallelogram(vec3(-0.4, -0.3, 0.0), vec3(0.8, 0.6, 0.0), Vec3::Z * 0.8);
    let right = parallelogram(vec3(-0.3, 0.3, 0.0), vec3(0.8, -0.7, 0.0), Vec3::Z * 0.8);
    let plate = parallelogram(vec3(0.0, -0.7, 0.1), vec3(0.3, 0.1, 0.0), Vec3::Z * 0.3);
    let scene = small_floor()
        .solid("left", left, [0.5; 3])
        .solid("right", right, [0.5; 3])
        .solid("plate", plate, [0.2, 0.6, 0.4])
        .constant_environment(SKY);
    let scene = scene.depth(4).mirror("left").mirror("right");
    let [found, lost] = found_and_lost(&scene, "plate.translation");
    assert_eq!(lost, 0, "of {found}");
    checked(&scene, 256, "plate.translation", &MOVED, 0.02);
}

/// A ball of 1280 flat mirrors is cut at 16 edges of facets between two points of a line. Those
/// that are left show different places, and lose nothing.
#[test]
fn many_flat_mirrors() {
    let facets = ball(3, vec3(0.0, 0.0, 0.35), 0.3);
    let plate = parallelogram(vec3(0.4, -0.5, 0.02), vec3(0.3, 0.1, 0.0), Vec3::Z * 0.3);
    let scene = small_floor()
        .solid("facets", facets, [0.5; 3])
        .solid("plate", plate, [0.2, 0.6, 0.4])
        .constant_environment(SKY);
    let [found, lost] = found_and_lost(&scene.depth(4).mirror("facets"), "plate.translation");
    assert_eq!(lost, 0, "of {found}");
}

/// Facets smaller than the distance between samples: each is found with its neighbours.
#[test]
fn an_edge_in_very_small_facets() {
    let mut scene = ball_before_a_plate().depth(2);
    scene.meshes.retain(|m| m.id != "ball");
    let facets = ball(5, Vec3::ZERO, 0.5);
    let scene = scene.solid("facets", facets, [0.5; 3]).mirror("facets");
    // In a facet this small the world is seen through a keyhole.
    let parts = [("near.translation", MOVED.as_slice())];
    check_to(0.1, &scene, &parts, 64, Some(0.003), Fails);
}

#[test]
fn an_edge_behind_a_lens() {
    let scene = ball_before_a_plate().depth(4).clear("ball");
    checked(&scene, 256, "plate.translation", &MOVED, 0.04);
    checked(&scene, 256, "ball.translation", &MOVED, 0.02);
    checked(&scene, 256, "ball.bsdf.eta", &[1.0], 0.02);
}

#[test]
fn smooth_plastic() {
    let scene = close_up().constant_environment(SKY).depth(3);
    let scene = scene.plastic("floor", None);
    checked(&scene, 256, "block.translation", &MOVED, 0.01);
}

#[test]
fn behind_a_null_surface() {
    let scene = close_up().constant_environment(SKY).depth(3).null("block");
    checked(&scene, 256, "block.translation", &MOVED, 0.02);
    checked(&scene, 256, "cam.translation", &MOVED, 0.01);
}

/// A checkerboard is seen in a mirror with all its edges.
#[test]
fn a_checkerboard_in_a_mirror() {
    let board = placed(floor(0.6, 0.0), vec3(-90.0, 0.0, 0.0), vec3(0.1, 0.9, 0.7));
    let scene = small_floor()
        .solid("board", board, [0.5; 3])
        .constant_environment(SKY)
        .checkerboard("board");
    let scene = scene.depth(3).mirror("floor");
    checked(&scene, 256, "board.translation", &MOVED, 0.02);
}

/// Glass, a mirror, smooth plastic and what does nothing, in one room.
#[test]
fn transposition() {
    let block = |at: Vec3| placed(cuboid(Vec3::splat(0.25)), vec3(10.0, 20.0, 30.0), at);
    let scene = scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        GAUSSIAN,
    )
    .solid("floor", floor(1.5, 0.0), [0.5; 3])
    .smooth("mirror", ball(2, vec3(0.5, -0.1, 0.4), 0.35), [0.5; 3])
    .solid("flat", block(vec3(-0.6, 0.4, 0.4)), [0.5; 3])
    .smooth("glass", ball(2, vec3(-0.2, -0.8, 0.5), 0.3), [0.5; 3])
    .solid("plastic", block(vec3(-0.9, -0.5, 0.3)), [0.5; 3])
    .solid("nothing", block(vec3(0.9, 0.8, 0.3)), [0.5; 3])
    .light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
    .constant_environment(SKY)
    .mirror("mirror")
    .mirror("flat")
    .clear("glass")
    .plastic("plastic", None)
    .null("nothing")
    .depth(4);
    let painted = ["mirror", "flat", "glass", "plastic", "nothing", "lamp"];
    let idle = painted.map(|id| format!("{id}.bsdf.brdf_0.reflectance.value"));
    let idle: Vec<&str> = idle.iter().map(String::as_str).collect();
    transposed(&scene, Method::Reparam, &idle);
}
