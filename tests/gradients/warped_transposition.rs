//! Methods that move samples: forward and reverse mode are transposes of one matrix, on the same
//! random numbers.

use common::fading::fading;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{Distribution, Filter, Scene};

/// A black lamp, and colours of what has been painted over.
const IDLE: &[&str] = &[
    "lamp.bsdf.brdf_0.reflectance.value",
    "corner.bsdf.brdf_0.reflectance.value",
    "ball.bsdf.brdf_0.reflectance.value",
    "plate.bsdf.brdf_0.reflectance.value",
];

/// Diffuse, glossy and coated things between a lamp with a picture and the sky.
fn everything(filter: Filter, depth: u32) -> Scene {
    let scene = scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        filter,
    )
    .depth(depth)
    .solid("floor", floor(1.5, 0.0), [0.6, 0.5, 0.7])
    .solid(
        "corner",
        placed(
            l_shape(0.4, 0.5),
            vec3(5.0, 3.0, 20.0),
            vec3(-0.6, 0.4, 0.02),
        ),
        [0.7, 0.3, 0.2],
    )
    .metal("corner", 0.1, Distribution::Ggx)
    .smooth("ball", ball(2, vec3(0.5, -0.1, 0.3), 0.4), [0.2, 0.6, 0.3])
    .plastic("ball", Some(0.3))
    .solid(
        "plate",
        placed(floor(0.3, 0.0), vec3(10.0, 5.0, 0.0), vec3(-0.5, -0.7, 0.3)),
        [0.5; 3],
    )
    .plastic("plate", Some(0.05));
    scene.light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
}

fn under_the_sky(filter: Filter, depth: u32) -> Scene {
    everything(filter, depth).constant_environment([0.3, 0.4, 0.5])
}

fn under_a_sun(filter: Filter, depth: u32) -> Scene {
    everything(filter, depth).sunny()
}

#[test]
fn loubet_depth_2() {
    transposed(&under_the_sky(TENT, 2), Method::Loubet, IDLE);
}

#[test]
fn loubet_depth_4() {
    transposed(&under_a_sun(GAUSSIAN, 4), Method::Loubet, IDLE);
}

#[test]
fn warped_area_depth_2() {
    transposed(&under_the_sky(TENT, 2), Method::WarpedArea, IDLE);
}

#[test]
fn warped_area_depth_4() {
    transposed(&under_a_sun(GAUSSIAN, 4), Method::WarpedArea, IDLE);
}

/// A lamp that is a picture, so that it matters where its light comes from.
#[test]
fn lamps_with_pictures() {
    let lamp = floor(0.5, 0.0);
    let lamp = placed(lamp, vec3(180.0, 0.0, 0.0), vec3(0.1, 0.0, 2.0));
    let scene = scene(vec3(0.4, -4.0, 2.2), Vec3::ZERO, 40.0, [10, 8], GAUSSIAN)
        .depth(3)
        .solid("floor", floor(1.5, 0.0), [0.6, 0.5, 0.7])
        .solid("ball", ball(1, vec3(0.2, -0.1, 0.7), 0.3), [0.2, 0.6, 0.3])
        .light("lamp", lamp, [5.0, 6.0, 4.0]);
    let scene = fading(scene, "lamp");
    transposed(&scene, Method::Loubet, IDLE);
    transposed(&scene, Method::WarpedArea, IDLE);
}
