//! Walls that directions graze: points close to their planes follow them.

use common::comparison::{Interior::Fails, check_to};
use common::scenes::*;
use common::transposition::transposed;
use common::{direction, gradient, settings};
use glam::vec3;
use warpath::methods::Method;
use warpath::scene::Scene;

/// The foot of a wall, which has its light from a spot far up the wall. Floor and wall pass through
/// each other.
fn corner() -> Scene {
    let (along, up) = (vec3(0.0, 4.0, 0.0), vec3(0.0, 0.0, 4.0));
    let floor = parallelogram(vec3(-0.5, -2.0, 0.0), vec3(4.0, 0.0, 0.0), along);
    let wall = parallelogram(vec3(0.0, -2.0, -0.5), along, up);
    let corner = vec3(0.2, -0.1, 1.9);
    let lamp = parallelogram(corner, up * 0.05, along * 0.05);
    scene(
        vec3(0.8, -0.6, 1.2),
        vec3(0.06, 0.0, 0.0),
        6.0,
        [8; 2],
        GAUSSIAN,
    )
    .depth(3)
    .solid("floor", floor, [0.7, 0.6, 0.5])
    .solid("wall", wall, [0.8, 0.6, 0.5])
    .light("lamp", lamp, [40.0, 50.0, 60.0])
}

const WALL: [(&str, &[f32]); 1] = [("wall.translation", &[1.0, 0.2, 0.1])];
const FLOOR: [(&str, &[f32]); 1] = [("floor.translation", &[1.0, 0.1, 0.3])];

#[test]
fn a_wall_that_moves() {
    check_to(0.03, &corner(), &WALL, 1024, None, Fails);
}

#[test]
fn points_beside_it_that_move() {
    check_to(0.06, &corner(), &FLOOR, 4096, None, Fails);
}

#[test]
fn transposition() {
    transposed(
        &corner(),
        Method::Reparam,
        &["lamp.bsdf.brdf_0.reflectance.value"],
    );
}

/// Mean over pixels of the variance between runs.
fn variance(scene: &Scene, seeds: std::ops::Range<u64>) -> f64 {
    let along = direction(scene, &WALL);
    let count = (seeds.end - seeds.start) as f64;
    let of = |seed| gradient(scene, &settings(scene, Method::Reparam, 64, seed), &along);
    let runs: Vec<Vec<f64>> = seeds.map(of).collect();
    let of_number = |i: usize| {
        let mean = runs.iter().map(|r| r[i]).sum::<f64>() / count;
        runs.iter().map(|r| (r[i] - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    (0..runs[0].len()).map(of_number).sum::<f64>()
}

/// Beside a floor of many times its size, under everything, a wall is none that is followed.
#[test]
fn following_is_less_noise() {
    let alone = corner();
    let beside = corner().solid("ground", floor(20.0, -1.0), [0.0; 3]);
    let ratio: Vec<f64> = [1..9, 9..17, 17..25, 25..33]
        .map(|seeds| variance(&beside, seeds.clone()) / variance(&alone, seeds))
        .into();
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| *r > 20.0), "{ratio:?}");
}
