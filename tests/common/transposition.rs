//! Forward and reverse mode as transposes of one matrix.

use super::shapes::Random;
use super::{Direction, Quiet, dot, flat, settings};
use warpath::methods::{Image, Method, Objective, Prepared, Settings, Statistics};
use warpath::scene::parameters::{self, Parameter};
use warpath::scene::{Scene, SceneDifferential};

/// What single precision may lose, per unit of the terms' magnitudes, at paths of up to this many
/// segments. Along longer chains grazing rays multiply what has been rounded before.
pub fn rounding(depth: u32) -> f64 {
    if depth <= 2 { 3e-5 } else { 3e-4 }
}

/// Samples of a pixel.
const SPP: u32 = if cfg!(feature = "all-samples") {
    32
} else {
    16
};

/// Every parameter that can be differentiated.
pub fn all_parameters(scene: &Scene) -> Vec<Parameter> {
    parameters::list(scene)
        .into_iter()
        .filter(|p| p.differentiable)
        .collect()
}

pub fn random_values(random: &mut Random, count: usize) -> Vec<f32> {
    (0..count).map(|_| 2.0 * random.unit() - 1.0).collect()
}

pub fn random_weight(random: &mut Random, scene: &Scene) -> Image {
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
        .chain(d.delta_lights.iter().flatten())
        .map(|v| v.to_array());
    let colours = d.texels.iter().flatten().flatten().copied();
    let camera = d.camera.iter().flat_map(|c| {
        [
            c.translation.to_array(),
            c.rotation.to_array(),
            [c.x_fov_deg, 0.0, 0.0],
        ]
    });
    let environment = d
        .environment
        .iter()
        .flat_map(|e| [e.rotation.to_array(), [e.scale, 0.0, 0.0]]);
    vectors
        .chain(colours)
        .chain(camera)
        .chain(environment)
        .flatten()
        .chain(d.to_uv.iter().flatten().flatten().copied())
        .map(f64::from)
}

/// The scene, ready to be traced by one thread.
pub fn prepared(scene: &Scene) -> Prepared<'_> {
    let settings = settings(scene, Method::Interior, 1, 0);
    Prepared::new(scene, &settings, &|| false).expect("a scene")
}

/// ⟨J·v, w⟩ and ⟨v, Jᵀ·w⟩.
pub struct Sides {
    pub forward: f64,
    pub reverse: f64,
    /// What they may differ by; zero where nothing was differentiated.
    pub allowed: f64,
    /// Terms that were left out of either because they were not finite.
    pub rejected: u64,
}

/// The two sides along a direction, for the weight of an image.
pub fn both_sides(
    prepared: &Prepared,
    direction: &Direction,
    weight: &Image,
    method: Method,
) -> Sides {
    let settings = settings(prepared.scene, method, SPP, 4);
    both_sides_by(prepared, direction, weight, settings)
}

/// The same by settings of one's own.
pub fn both_sides_by(
    prepared: &Prepared,
    direction: &Direction,
    weight: &Image,
    settings: Settings,
) -> Sides {
    let scene = prepared.scene;
    let settings = Settings {
        standard_error: true,
        ..settings
    };
    let forward = prepared.forward(&settings, direction, &Quiet);
    let result = forward.expect("a gradient image");
    let (image, weights) = (flat(&result.gradient), flat(weight));
    let wanted: Vec<Parameter> = direction.iter().map(|d| d.0.clone()).collect();
    let objective = Objective::Adjoint(weight);
    let backward = prepared.backward(&settings, &wanted, &objective, &Quiet);
    let pulled = backward.expect("a gradient");
    let tangent = parameters::tangent(scene, direction, 0).expect("a tangent");

    let reduced = direction.iter().map(|(p, _)| pulled.gradient.by(scene, p));
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
    let groups = pulled.groups.iter().map(|group| &group.cotangent);
    let groups = groups.map(of_group).sum::<f64>() / pulled.groups.len() as f64;
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
    let rejected = [&result.statistics, &pulled.statistics].map(not_finite);
    Sides {
        forward: dot(&image, &weights),
        reverse,
        allowed: if terms == 0.0 { 0.0 } else { allowed },
        rejected: rejected.iter().sum(),
    }
}

/// What was left out because it was not finite, of the image or of its gradient.
fn not_finite(statistics: &Statistics) -> u64 {
    let causes = statistics.rejected.iter();
    causes
        .filter(|(cause, _)| cause.contains("not_finite"))
        .map(|(_, count)| count)
        .sum()
}

/// What is wrong with the two sides, if anything.
pub fn difference(what: &str, sides: &Sides) -> Option<String> {
    let Sides {
        forward,
        reverse,
        allowed,
        rejected,
    } = sides;
    let error = (forward - reverse).abs();
    let is_equal = forward.is_finite() && reverse.is_finite() && error <= *allowed;
    (!is_equal || *rejected != 0).then(|| {
        format!(
            "{what}: forward {forward:e}, reverse {reverse:e}, off by {error:.1e} of {allowed:.1e}; \
             {rejected} terms left out"
        )
    })
}

/// All parameters at once and each alone; those named may matter to nothing.
pub fn transposed(scene: &Scene, method: Method, idle: &[&str]) {
    let mut random = Random::new(u64::from(scene.integrator.max_depth));
    let direction: Direction = all_parameters(scene)
        .into_iter()
        .map(|p| (p.clone(), random_values(&mut random, p.len())))
        .collect();
    let weight = random_weight(&mut random, scene);
    let prepared = prepared(scene);
    let mut wrong = Vec::new();
    wrong.extend(difference(
        "all",
        &both_sides(&prepared, &direction, &weight, method),
    ));
    for part in direction.chunks(1) {
        let sides = both_sides(&prepared, &part.to_vec(), &weight, method);
        let key = &part[0].0.key;
        wrong.extend(difference(key, &sides));
        if sides.allowed == 0.0 && !idle.contains(&key.as_str()) {
            wrong.push(format!("{key}: nothing was differentiated"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
