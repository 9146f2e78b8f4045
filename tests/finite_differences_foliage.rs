//! As `finite_differences`: many small things before one another, close to what sees them.

mod common;

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::{Random, Shape, soup};
use glam::vec3;
use warpath::scene::Distribution::Ggx;
use warpath::scene::Scene;

/// Leaves strewn over a floor.
fn leaves() -> Shape {
    let (positions, triangles) = soup(&mut Random::new(3), 40, 0.35);
    let over_floor = |p: glam::Vec3| p * vec3(0.6, 0.6, 0.2) + vec3(0.0, 0.0, 0.3);
    (positions.into_iter().map(over_floor).collect(), triangles)
}

fn foliage() -> Scene {
    scene(
        vec3(0.3, -3.4, 1.9),
        vec3(0.0, 0.0, 0.2),
        26.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(0.8, 0.0), [0.6, 0.5, 0.4])
    .solid("leaves", leaves(), [0.2, 0.6, 0.1])
    .sky(SKY)
}

const MOVED: (&str, &[f32]) = ("leaves.translation", &[1.0, 0.2, 0.1]);

#[test]
fn lit_by_the_sky() {
    check(&foliage(), &[MOVED], 512, None, Fails);
}

#[test]
fn lit_by_one_another() {
    check(&foliage().depth(3), &[MOVED], 512, None, Fails);
}

#[test]
fn seen_in_a_reflection() {
    let scene = foliage().depth(3).metal("floor", 0.05, Ggx);
    check(&scene, &[MOVED], 512, None, Fails);
}
