//! Cameras whose lens has an extent: against finite differences, and the other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{Lens, Scene};

/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);

/// A black plate before what is in focus, and one behind it: each point of the lens sees other
/// parts of the sky. The circle of confusion is four pixels wide on the one, and two on the other.
fn plates(depth: u32) -> Scene {
    let near = parallelogram(vec3(-0.9, -0.8, -0.3), Vec3::X * 0.8, Vec3::Z * 0.9);
    let far = parallelogram(vec3(0.0, 1.0, -0.2), Vec3::X * 0.9, Vec3::Z * 0.7);
    let mut scene = scene(vec3(0.2, -3.4, 0.6), Vec3::ZERO, 34.0, [16; 2], GAUSSIAN)
        .solid("floor", floor(1.5, -0.6), [0.6, 0.5, 0.4])
        .solid("near", near, [0.0; 3])
        .solid("far", far, [0.2, 0.3, 0.1])
        .constant_environment(SKY)
        .depth(depth);
    scene.sensors[0].lens = Lens::Thin {
        aperture_radius: 0.25,
        focus_distance: 3.4,
    };
    scene
}

fn checked(scene: &Scene, key: &str, by: &[f32], step: Option<f64>) {
    println!("{key}");
    check_to(0.03, scene, &[(key, by)], 256, step, Fails);
}

#[test]
fn what_is_out_of_focus_moves() {
    checked(&plates(2), "near.translation", &[1.0, 0.0, 0.2], STEP);
    checked(&plates(2), "far.translation", &[1.0, 0.3, 0.2], STEP);
}

#[test]
fn the_camera_moves_and_turns() {
    checked(&plates(2), "cam.translation", &[1.0, 0.4, 0.2], STEP);
    checked(&plates(2), "cam.rotation", &[0.2, 0.3, 1.0], Some(0.003));
    checked(&plates(2), "cam.x_fov", &[1.0], Some(0.2));
}

/// Drawn edges and chains through smooth surfaces know of the lens, too.
#[test]
fn transposition() {
    let ball = ball(2, vec3(-0.3, 0.3, -0.1), 0.35);
    let scene = plates(3).smooth("ball", ball, [0.5; 3]);
    transposed(&scene, Method::Edges, &[]);
    transposed(
        &scene.mirror("ball"),
        Method::Reparam,
        &["ball.bsdf.brdf_0.reflectance.value"],
    );
}
