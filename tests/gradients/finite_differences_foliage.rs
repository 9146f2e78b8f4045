//! As `finite_differences`: many small things before one another, close to what sees them.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use glam::{Vec3, vec3};
use warpath::scene::Distribution::Ggx;

const MOVED: (&str, &[f32]) = ("leaves.translation", &[1.0, 0.2, 0.1]);

#[test]
fn lit_by_the_sky() {
    check(&foliage(), &[MOVED], 512, None, Fails);
}

#[test]
fn lit_by_one_another() {
    check(&foliage().depth(3), &[MOVED], 512, None, Fails);
}

/// The film drifts with leaves that rest.
#[test]
fn seen_by_a_moving_camera() {
    let moved = ("cam.translation", [0.3, 0.0, 0.1].as_slice());
    check(&foliage().depth(3), &[moved], 512, None, Fails);
}

#[test]
fn seen_in_a_reflection() {
    let scene = foliage().depth(3).metal("floor", 0.05, Ggx);
    check(&scene, &[MOVED], 512, None, Fails);
}

/// A slit is found wherever its two rims hide what is behind: no point of a line need lie in it,
/// and nothing must be made of the chance that one does.
#[test]
fn lit_through_a_slit() {
    let plate = |x: f32, width: f32| {
        parallelogram(vec3(x, -0.5, 0.5), Vec3::X * width, vec3(0.0, 1.0, 0.0))
    };
    let scene = small_floor()
        .solid("left", plate(-0.6, 0.6), [0.0; 3])
        .solid("right", plate(0.03, 0.57), [0.0; 3])
        .constant_environment(SKY)
        .depth(3);
    let opened: (&str, &[f32]) = ("right.translation", &[1.0, 0.0, 0.0]);
    check(&scene, &[opened], 256, Some(2e-3), Fails);
}
