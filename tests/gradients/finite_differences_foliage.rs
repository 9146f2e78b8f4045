//! As `finite_differences`: many small things before one another, close to what sees them.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::{Random, Shape, soup};
use common::{Quiet, direction, settings};
use glam::{Vec3, vec3};
use warpath::methods::{self, Method};
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

/// A blind of 200 slats that overlap: a shadow's end is found from all of it, slat after slat.
#[test]
fn lit_past_a_blind() {
    const SLATS: u32 = 200;
    let slat = |i: u32| {
        let x = -0.5 + 0.005 * i as f32;
        let corner = vec3(x, -0.6, 1.0 + 0.002 * (i % 3) as f32);
        parallelogram(corner, Vec3::X * 0.008, Vec3::Y * 1.2)
    };
    let mut blind: Shape = Default::default();
    for (positions, triangles) in (0..SLATS).map(slat) {
        let first = blind.0.len() as u32;
        blind.0.extend(positions);
        blind
            .1
            .extend(triangles.iter().map(|t| t.map(|v| v + first)));
    }
    let scene = scene(
        vec3(0.3, -3.4, 0.6),
        vec3(0.3, 0.0, 0.0),
        30.0,
        [12; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(2.0, 0.0), [0.6, 0.5, 0.4])
    .solid("blind", blind, [0.5; 3])
    .light("lamp", ceiling(vec3(0.0, 0.0, 2.0), 0.8), [3.0; 3])
    .depth(2);
    let moved = ("blind.translation", [1.0, 0.3, 0.2].as_slice());
    check_to(0.03, &scene, &[moved], 64, Some(0.01), Fails);
    let settings = settings(&scene, Method::Reparam, 16, 3);
    let along = direction(&scene, &[moved]);
    let found = methods::forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
    assert_eq!(found.statistics.rejected.get("silhouette_not_found"), None);
}

/// Specks of a tenth of a pixel grow before a floor that half of all light samples leave black:
/// what is met by a small chance is looked at again, also where the first look found nothing. On
/// many lines over the lamp all points are hidden, and light passes between them.
#[test]
fn specks_before_shadows() {
    let (positions, triangles) = soup(&mut Random::new(11), 2000, 0.035);
    let over_floor = |p: Vec3| p * vec3(0.4, 0.4, 0.1) + vec3(0.0, 0.0, 0.15);
    let positions: Vec<Vec3> = positions.into_iter().map(over_floor).collect();
    let grow = |speck: &[Vec3]| -> Vec<f32> {
        let middle = speck.iter().sum::<Vec3>() / 3.0;
        speck
            .iter()
            .flat_map(|p| ((*p - middle) * 100.0).to_array())
            .collect()
    };
    let plate = parallelogram(vec3(0.5, 0.6, 1.48), Vec3::X * 1.4, Vec3::Y);
    let growth: Vec<f32> = positions.chunks(3).flat_map(grow).collect();
    let scene = scene(vec3(0.0, -0.5, 4.0), Vec3::ZERO, 16.0, [8; 2], GAUSSIAN)
        .solid("floor", floor(1.5, 0.0), [0.6, 0.5, 0.4])
        .solid("specks", (positions, triangles), [0.0; 3])
        .light("lamp", ceiling(vec3(1.2, 0.6, 1.5), 0.3), [9.0; 3])
        .solid("half", plate, [0.0; 3])
        .depth(2);
    let moved = ("specks.vertex_positions", growth.as_slice());
    check_to(0.02, &scene, &[moved], 256, Some(0.001), Fails);
}
