//! Forward and reverse mode are transposes of one matrix: ⟨J·v, w⟩ = ⟨v, Jᵀ·w⟩, from the same
//! random numbers.
//!
//! Both sides sum the same products in single precision and in different order, so they differ by
//! rounding: by far less than the sum of all magnitudes. A term that one of them lacks shows at
//! once.

use common::scenes::*;
use common::shapes::Random;
use common::transposition::{
    Sides, all_parameters, difference, random_values, random_weight, rounding, transposed,
};
use common::{Direction, dot, flat, gradient, pull_back, settings};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::parameters::Parameter;
use warpath::scene::{DeltaLightKind, Filter, Scene};

/// A black lamp out of sight: its own colour does not matter.
const IDLE: &[&str] = &["lamp.bsdf.brdf_0.reflectance.value"];

/// A bit of everything: flat, smooth (normals of both kinds), concave and intersecting meshes, a
/// paired and an unpaired light, an environment.
fn everything(filter: Filter, depth: u32) -> Scene {
    let tilted = ball(1, Vec3::ZERO, 0.35);
    let normals = tilted.0.iter().map(|p| p.normalize()).collect();
    let triangle = (
        vec![
            vec3(1.2, 0.6, 1.3),
            vec3(1.2, -0.5, 1.4),
            vec3(0.9, 0.1, 2.0),
        ],
        vec![[0, 1, 2]],
    );
    scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        filter,
    )
    .depth(depth)
    .constant_environment([0.3, 0.4, 0.5])
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
    .smooth("ball", ball(2, vec3(0.5, -0.1, 0.3), 0.4), [0.2, 0.6, 0.3])
    .with_normals(
        "given",
        placed(tilted, Vec3::ZERO, vec3(-0.4, -0.8, 0.5)),
        normals,
        [0.5, 0.5, 0.8],
    )
    .light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
    .light("wedge", triangle, [3.0, 2.0, 4.0])
}

#[test]
fn box_filter_depth_2() {
    transposed(&everything(BOX, 2), Method::Reparam, IDLE);
}

#[test]
fn box_filter_depth_4() {
    transposed(&everything(BOX, 4), Method::Reparam, IDLE);
}

#[test]
fn tent_filter_depth_2() {
    transposed(&everything(TENT, 2), Method::Reparam, IDLE);
}

#[test]
fn gaussian_filter_depth_3() {
    transposed(&everything(GAUSSIAN, 3), Method::Reparam, IDLE);
}

#[test]
fn gaussian_filter_depth_4() {
    transposed(&everything(GAUSSIAN, 4), Method::Reparam, IDLE);
}

#[test]
fn sharp_shadows() {
    let position = vec3(-0.7, -0.8, 1.9);
    let direction = vec3(0.2, 0.3, -0.9).normalize();
    let lit = |scene: Scene| {
        scene
            .delta_light("bulb", DeltaLightKind::Point { position }, [3.0, 2.0, 4.0])
            .delta_light("sun", DeltaLightKind::Directional { direction }, [1.0; 3])
    };
    transposed(&lit(everything(BOX, 2)), Method::Reparam, IDLE);
    transposed(&lit(everything(GAUSSIAN, 3)), Method::Reparam, IDLE);
}

#[test]
fn interior_depth_2() {
    transposed(&everything(TENT, 2), Method::Interior, IDLE);
}

#[test]
fn interior_depth_4() {
    transposed(&everything(BOX, 4), Method::Interior, IDLE);
}

/// One reverse pass for all vertices of all meshes, and forward mode along ten directions of
/// theirs.
#[test]
fn one_pass_for_all_vertices() {
    let scene = everything(GAUSSIAN, 3);
    let mut random = Random::new(5);
    let wanted: Vec<Parameter> = all_parameters(&scene)
        .into_iter()
        .filter(|p| p.key.ends_with(".vertex_positions"))
        .collect();
    assert_eq!(wanted.len(), scene.meshes.len());
    let weight = random_weight(&mut random, &scene);
    let settings = settings(&scene, Method::Reparam, 16, 3);
    let gradients = pull_back(&scene, &settings, &wanted, &weight);
    let weights = flat(&weight);
    for turn in 0..10 {
        let direction: Direction = wanted
            .iter()
            .map(|p| (p.clone(), random_values(&mut random, p.len())))
            .collect();
        let forward = dot(&gradient(&scene, &settings, &direction), &weights);
        let pairs = gradients
            .iter()
            .zip(&direction)
            .flat_map(|(g, (_, v))| g.iter().zip(v));
        let terms: Vec<f64> = pairs.map(|(g, v)| f64::from(*g) * f64::from(*v)).collect();
        let magnitude: f64 = terms.iter().map(|t| t.abs()).sum();
        let sides = Sides {
            forward,
            reverse: terms.iter().sum(),
            allowed: rounding(3) * magnitude,
            rejected: 0,
        };
        let wrong = difference(&format!("direction {turn}"), &sides);
        assert!(wrong.is_none(), "{wrong:?}");
    }
}
