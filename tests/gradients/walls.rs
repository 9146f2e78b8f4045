//! Walls that directions graze: points close to their planes follow them.

use common::comparison::{Interior::Fails, check_to};
use common::noise_ratios;
use common::scenes::*;
use common::transposition::transposed;
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
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
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

/// Beside a floor of many times its size, under everything, a wall is none that is followed.
#[test]
fn following_is_less_noise() {
    let alone = corner();
    let beside = corner().solid("ground", floor(20.0, -1.0), [0.0; 3]);
    let ratio = noise_ratios([&beside, &alone], &WALL, [1..9, 9..17, 17..25, 25..33]);
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| *r > 20.0), "{ratio:?}");
}
