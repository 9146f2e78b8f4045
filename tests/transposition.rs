//! Forward and reverse mode are transposes of one matrix: ⟨J·v, w⟩ = ⟨v, Jᵀ·w⟩, from the same random numbers.
//!
//! Both sides sum the same products in single precision and in different order, so they differ by rounding: by
//! far less than the sum of all magnitudes. A term that one of them lacks shows at once.

mod common;

use common::scenes::*;
use common::shapes::Random;
use common::{Direction, Quiet, dot, flat, gradient, pull_back, settings};
use glam::{Vec3, vec3};
use warpath::methods::{Image, Method, Objective, Settings, backward, forward};
use warpath::scene::parameters::{self, Parameter};
use warpath::scene::{Filter, Scene, SceneDifferential};

/// What single precision may lose, per unit of the terms' magnitudes, at paths of up to this many segments. Along
/// longer chains grazing rays multiply what has been rounded before.
fn rounding(depth: u32) -> f64 {
    if depth <= 2 { 3e-5 } else { 3e-4 }
}

/// A bit of everything: flat, smooth (normals of both kinds), concave and intersecting meshes, a paired and an
/// unpaired light, an environment.
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
    .sky([0.3, 0.4, 0.5])
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

/// Every parameter that can be differentiated.
fn all_parameters(scene: &Scene) -> Vec<Parameter> {
    parameters::list(scene)
        .into_iter()
        .filter(|p| p.differentiable)
        .collect()
}

fn random_values(random: &mut Random, count: usize) -> Vec<f32> {
    (0..count).map(|_| 2.0 * random.unit() - 1.0).collect()
}

fn random_weight(random: &mut Random, scene: &Scene) -> Image {
    let [width, height] = scene.sensors[0].film.crop_size.map(|s| s as usize);
    let pixels = (0..width * height)
        .map(|_| random.cube().to_array())
        .collect();
    Image {
        width,
        height,
        pixels,
    }
}

/// All numbers of a scene's tangent or cotangent, in one order.
fn numbers(d: &SceneDifferential) -> impl Iterator<Item = f64> + '_ {
    let vectors = d
        .positions
        .iter()
        .chain(&d.given_normals)
        .flatten()
        .flatten()
        .map(|v| v.to_array());
    let colours = d.texels.iter().flatten().flatten().copied();
    let camera = d.camera.iter().flat_map(|c| {
        [
            c.translation.to_array(),
            c.rotation.to_array(),
            [c.x_fov_deg, 0.0, 0.0],
        ]
    });
    vectors
        .chain(colours)
        .chain(camera)
        .flatten()
        .map(f64::from)
}

/// The two sides, and what they may differ by.
fn both_sides(scene: &Scene, direction: &Direction, weight: &Image, method: Method) -> [f64; 3] {
    let settings = Settings {
        standard_error: true,
        ..settings(scene, method, 16, 4)
    };
    let result = forward(scene, &settings, direction, &Quiet).expect("a gradient image");
    let (image, weights) = (flat(&result.gradient), flat(weight));
    let wanted: Vec<Parameter> = direction.iter().map(|d| d.0.clone()).collect();
    let objective = Objective::Adjoint(weight);
    let pulled = backward(scene, &settings, &wanted, &objective, &Quiet).expect("a gradient");
    let named: Vec<(&str, &[f32])> = direction
        .iter()
        .map(|(p, v)| (p.key.as_str(), v.as_slice()))
        .collect();
    let tangent = parameters::tangent(scene, &named, 0).expect("a tangent");

    let reduced = direction
        .iter()
        .map(|(p, _)| parameters::reduce(scene, p, &pulled.gradient));
    let products = reduced
        .zip(direction)
        .flat_map(|(g, (_, v))| g.into_iter().zip(v));
    let reverse = products.map(|(g, v)| f64::from(g) * f64::from(*v)).sum();
    // Magnitudes before vertices are summed up to a pose, and one group of samples at a time.
    let of_group = |g| {
        numbers(g)
            .zip(numbers(&tangent))
            .map(|(g, v)| (g * v).abs())
            .sum::<f64>()
    };
    let groups = pulled.groups.iter().map(of_group).sum::<f64>() / pulled.groups.len() as f64;
    let magnitude = |image: &[f64]| {
        image
            .iter()
            .zip(&weights)
            .map(|(a, b)| (a * b).abs())
            .sum::<f64>()
    };
    let terms = groups.max(magnitude(&image));
    // Terms of a sample that cancel leave the last places of its radiance.
    let last_places = f64::from(f32::EPSILON) * magnitude(&flat(&result.image));
    let allowed = rounding(scene.integrator.max_depth) * terms + last_places;
    [
        dot(&image, &weights),
        reverse,
        if terms == 0.0 { 0.0 } else { allowed },
    ]
}

/// What is wrong with the two sides, if anything.
fn difference(what: &str, [forward, reverse, allowed]: [f64; 3]) -> Option<String> {
    let error = (forward - reverse).abs();
    let is_equal = forward.is_finite() && reverse.is_finite() && error <= allowed;
    (!is_equal).then(|| {
        format!(
            "{what}: forward {forward:e}, reverse {reverse:e}, off by {error:.1e} of {allowed:.1e}"
        )
    })
}

/// All parameters at once and each alone.
fn transposed(filter: Filter, depth: u32, method: Method) {
    let scene = everything(filter, depth);
    let mut random = Random::new(u64::from(depth));
    let parameters = all_parameters(&scene);
    assert!(parameters.len() > 30, "{} parameters", parameters.len());
    let direction: Direction = parameters
        .into_iter()
        .map(|p| (p.clone(), random_values(&mut random, p.len())))
        .collect();
    let weight = random_weight(&mut random, &scene);
    let mut wrong = Vec::new();
    wrong.extend(difference(
        "all",
        both_sides(&scene, &direction, &weight, method),
    ));
    for part in direction.chunks(1) {
        let sides = both_sides(&scene, &part.to_vec(), &weight, method);
        let key = &part[0].0.key;
        wrong.extend(difference(key, sides));
        // A black lamp out of sight is the one thing whose colour does not matter.
        if sides[2] == 0.0 && key != "lamp.bsdf.brdf_0.reflectance.value" {
            wrong.push(format!("{key}: nothing was differentiated"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn box_filter_depth_2() {
    transposed(BOX, 2, Method::Reparam);
}

#[test]
fn box_filter_depth_4() {
    transposed(BOX, 4, Method::Reparam);
}

#[test]
fn tent_filter_depth_2() {
    transposed(TENT, 2, Method::Reparam);
}

#[test]
fn gaussian_filter_depth_3() {
    transposed(GAUSSIAN, 3, Method::Reparam);
}

#[test]
fn gaussian_filter_depth_4() {
    transposed(GAUSSIAN, 4, Method::Reparam);
}

#[test]
fn interior_depth_2() {
    transposed(TENT, 2, Method::Interior);
}

#[test]
fn interior_depth_4() {
    transposed(BOX, 4, Method::Interior);
}

/// One reverse pass for all vertices of all meshes, and forward mode along ten directions of theirs.
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
        let sides = [forward, terms.iter().sum(), rounding(3) * magnitude];
        let wrong = difference(&format!("direction {turn}"), sides);
        assert!(wrong.is_none(), "{wrong:?}");
    }
}
