//! Later vertices look for shadows the more seldom the less light they send on, and what they find
//! stands for more. `edges` draws them for every vertex.

use common::comparison::compared;
use common::materials::*;
use common::scenes::*;
use common::{direction, runs};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Scene;

const RUNS: u64 = 16;
const SPP: u32 = 1024;
const SIGMAS: f64 = 4.0;
const RESOLUTION: f64 = 0.03;

/// A dark wall that leans over a bright floor, and a block behind it that shades the floor and that
/// the wall does not see.
fn dark_wall() -> Scene {
    let wall = parallelogram(
        vec3(-0.4, 1.9, -0.3),
        vec3(0.8, 0.0, 0.0),
        vec3(0.0, -0.4, 0.6),
    );
    let block = placed(
        cuboid(vec3(0.5, 0.3, 0.05)),
        vec3(4.0, 7.0, 21.0),
        vec3(0.1, 1.5, 0.7),
    );
    scene(Vec3::ZERO, vec3(0.0, 1.7, 0.0), 12.0, [8; 2], GAUSSIAN)
        .solid("wall", wall, [0.2, 0.3, 0.25])
        .solid("floor", floor(3.0, -0.8), [0.8, 0.7, 0.6])
        .solid("block", block, [0.05; 3])
        .depth(3)
}

fn check(what: &str, scene: &Scene) {
    let along = direction(scene, &[("block.translation", &[0.2, 0.3, 1.0])]);
    let ours = |spp| runs(scene, (Method::Reparam, spp), &along, 1..1 + RUNS);
    let theirs = |spp| runs(scene, (Method::Edges, spp), &along, 100..100 + RUNS);
    println!("{what}");
    let agreement = compared(SPP, RESOLUTION, [&ours, &theirs]).agreement;
    assert!(agreement.holds(SIGMAS), "{what}: {agreement:.4?}");
}

#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn of_a_lamp() {
    let lamp = placed(
        ceiling(Vec3::ZERO, 0.2),
        vec3(-3.0, 5.0, 13.0),
        vec3(0.1, 1.4, 1.6),
    );
    check("lamp", &dark_wall().light("lamp", lamp, [30.0, 25.0, 20.0]));
}

#[test]
fn of_an_even_sky() {
    check("sky", &dark_wall().constant_environment([1.0, 0.9, 0.8]));
}

#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn of_the_sun() {
    check("sun", &dark_wall().sunny());
}
