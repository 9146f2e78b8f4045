//! Samples have the distributions their densities claim: χ² tests with fixed seeds.
//!
//! All tests together reject a right sampler with probability 0.01; each gets its share by Šidák's formula. Points of
//! one stream are stratified, which χ² would call too good: every point here comes from a stream of its own.

mod common;

use common::scenes::*;
use glam::{Vec3, vec3};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use warpath::lanes::{LANES, Lane};
use warpath::paths::bounce::cosine_direction;
use warpath::paths::lights::Lights;
use warpath::paths::random::Stream;
use warpath::scene::Scene;
use warpath::trace::geometry::Geometry;

const ALPHA: f64 = 0.01;
/// How many χ² tests this file makes.
const TESTS: i32 = 14;
const SAMPLES: usize = 1 << 17;
/// Bins that expect fewer are put together.
const LEAST_EXPECTED: f64 = 10.0;

/// Panics if counts are too far from what was expected.
fn chi_squared(what: &str, counts: &[usize], expected: &[f64]) {
    assert_eq!(counts.len(), expected.len());
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    let (mut statistic, mut bins) = (0.0, 0);
    let (mut count, mut expects) = (0.0, 0.0);
    let last = order.len() - 1;
    for (place, bin) in order.into_iter().enumerate() {
        count += counts[bin] as f64;
        expects += expected[bin];
        if expects == 0.0 {
            assert_eq!(count, 0.0, "{what}: samples where none can be");
        } else if expects >= LEAST_EXPECTED || place == last {
            statistic += (count - expects).powi(2) / expects;
            bins += 1;
            (count, expects) = (0.0, 0.0);
        }
    }
    let tail = ChiSquared::new(f64::from(bins - 1))
        .expect("two bins or more")
        .sf(statistic);
    let share = 1.0 - (1.0 - ALPHA).powf(1.0 / f64::from(TESTS));
    println!("{what}: χ² {statistic:.1} with {bins} bins, p = {tail:.3}");
    assert!(
        tail >= share,
        "{what}: χ² {statistic:.1} with {bins} bins, p = {tail:e}"
    );
}

/// The same number expected in every bin.
fn uniform(what: &str, counts: &[usize]) {
    let share = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    chi_squared(what, counts, &vec![share; counts.len()]);
}

/// Bin of a number in [0, 1).
fn bin(x: f32, bins: usize) -> usize {
    assert!((0.0..1.0).contains(&x), "{x} is no fraction");
    (x * bins as f32) as usize
}

/// A pair of numbers of many streams: `dimension`, at the lattice point `index`.
fn pairs(seed: u64, dimension: u32, index: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..SAMPLES as u32).map(move |i| {
        let (x, y) = Stream::new(seed, [i / 512, i % 512]).pair(&[index; LANES], dimension);
        [x.to_array()[0], y.to_array()[0]]
    })
}

#[test]
fn pairs_fill_the_square() {
    for (dimension, index) in [(0, 0), (1, 5), (6, 77), (3, 4095)] {
        let mut counts = vec![0; 32 * 32];
        for [x, y] in pairs(11, dimension, index) {
            counts[bin(x, 32) * 32 + bin(y, 32)] += 1;
        }
        uniform(&format!("pair {dimension} at {index}"), &counts);
    }
}

/// Dimensions, neighbours and seeds know nothing of each other.
#[test]
fn streams_are_independent() {
    let joint = |what: &str,
                 a: &mut dyn Iterator<Item = [f32; 2]>,
                 b: &mut dyn Iterator<Item = [f32; 2]>| {
        let mut counts = vec![0; 8 * 8 * 8 * 8];
        for ([x, y], [z, w]) in a.zip(b) {
            counts[((bin(x, 8) * 8 + bin(y, 8)) * 8 + bin(z, 8)) * 8 + bin(w, 8)] += 1;
        }
        uniform(what, &counts);
    };
    joint("two dimensions", &mut pairs(3, 0, 9), &mut pairs(3, 1, 9));
    joint("two vertices", &mut pairs(3, 2, 9), &mut pairs(3, 6, 9));
    joint("two seeds", &mut pairs(3, 0, 9), &mut pairs(4, 0, 9));
    joint(
        "seeds that differ in their upper half",
        &mut pairs(3, 0, 9),
        &mut pairs(3 + (1 << 32), 0, 9),
    );
    joint(
        "neighbouring streams",
        &mut pairs(3, 0, 9),
        &mut pairs(3, 0, 9).skip(1),
    );
    let mut counts = vec![0; 16 * 16];
    for i in 0..SAMPLES as u32 {
        let stream = Stream::new(7, [i, 1]);
        counts[bin(stream.uniform(0), 16) * 16 + bin(stream.uniform(1), 16)] += 1;
    }
    uniform("a tile's shift", &counts);
}

/// cos θ/π over the hemisphere: sin²θ and φ are uniform.
#[test]
fn bounces_follow_the_cosine() {
    let mut counts = vec![0; 24 * 24];
    for [u, v] in pairs(5, 2, 3) {
        let [x, y, z] = cosine_direction(Lane::splat(u), Lane::splat(v)).map(|l| l.to_array()[0]);
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5 && z >= 0.0);
        let turn = y.atan2(x) / std::f32::consts::TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let sin_squared = (x * x + y * y).min(1.0 - 1e-7);
        counts[bin(sin_squared, 24) * 24 + bin(turn.min(1.0 - 1e-7), 24)] += 1;
    }
    uniform("bounces", &counts);
}

/// A parallelogram, a single triangle and a cube, of different power.
fn lamps() -> Scene {
    let triangle = (
        vec![
            vec3(3.0, 0.0, 1.0),
            vec3(3.0, 1.5, 1.2),
            vec3(3.4, 0.2, 2.5),
        ],
        vec![[0, 1, 2]],
    );
    scene(vec3(0.0, -4.0, 2.0), Vec3::ZERO, 40.0, [4; 2], BOX)
        .solid("floor", floor(2.0, 0.0), [0.5; 3])
        .light(
            "square",
            parallelogram(Vec3::ZERO, vec3(1.0, 0.2, 0.0), vec3(0.3, 0.8, 0.4)),
            [3.0, 2.0, 1.0],
        )
        .light("triangle", triangle, [1.0, 4.0, 2.0])
        .light(
            "cube",
            placed(
                cuboid(vec3(0.2, 0.1, 0.3)),
                vec3(10.0, 20.0, 30.0),
                vec3(-3.0, 0.0, 1.0),
            ),
            [6.0; 3],
        )
}

fn luminance([r, g, b]: [f32; 3]) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

/// Lights are picked by power: area times luminance.
#[test]
fn lights_are_picked_by_power() {
    let scene = lamps();
    let geometry = Geometry::new(&scene);
    let lights = Lights::new(&scene, &geometry, false);
    let mut power = vec![0.0; scene.area_lights.len()];
    for (light, power) in scene.area_lights.iter().zip(&mut power) {
        let mesh = &scene.meshes[light.mesh];
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
            *power += f64::from((b - a).cross(c - a).length()) / 2.0
                * luminance(scene.constant(light.radiance));
        }
    }
    let total: f64 = power.iter().sum();
    let (mut of_light, mut of_patch) = (vec![0; power.len()], vec![0; lights.patches.len() * 8]);
    for [u, _] in pairs(9, 1, 0) {
        let (patch, rest) = lights.pick(Lane::splat(u));
        of_light[lights.patches[patch[0] as usize].light as usize] += 1;
        of_patch[patch[0] as usize * 8 + bin(rest.to_array()[0], 8)] += 1;
    }
    let expected: Vec<f64> = power.iter().map(|p| p / total * SAMPLES as f64).collect();
    chi_squared("lights", &of_light, &expected);
    // What is left of the number is uniform again.
    let shares = lights
        .patches
        .iter()
        .flat_map(|p| [f64::from(p.probability) / 8.0; 8]);
    let expected: Vec<f64> = shares.map(|p| p * SAMPLES as f64).collect();
    chi_squared("patches", &of_patch, &expected);
}

/// Points of a light's own coordinates are spread evenly over its triangles' area.
#[test]
fn points_cover_the_lights() {
    let scene = lamps();
    let geometry = Geometry::new(&scene);
    let lights = Lights::new(&scene, &geometry, false);
    let range = geometry.first_triangle[1] as usize..geometry.triangles.len();
    // Each triangle is cut at the middles of its sides into four equal ones.
    let mut counts = vec![0; range.len() * 4];
    let mut expected = vec![0.0; counts.len()];
    let corners =
        |t: usize| geometry.triangles[range.start + t].map(|v| geometry.positions[v as usize]);
    let choices: Vec<[f32; 2]> = pairs(2, 0, 1).collect();
    for (i, [mut s, mut r]) in choices.into_iter().enumerate() {
        let patch = &lights.patches[i % lights.patches.len()];
        // As the tracer does it.
        if patch.upper.is_none() && s + r > 1.0 {
            (s, r) = (1.0 - s, 1.0 - r);
        }
        let (vertices, [b1, b2]) = patch.vertices_at(s, r);
        let [a, b, c] = vertices.map(|v| geometry.positions[v as usize]);
        let point = a + (b - a) * b1 + (c - a) * b2;
        assert!(
            (point - patch.point(s, r)).length() < 1e-5,
            "two places for one point"
        );
        assert!(
            b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0 + 1e-6,
            "outside its triangle"
        );
        let is_same = |t: usize| {
            vertices
                .iter()
                .all(|v| geometry.triangles[range.start + t].contains(v))
        };
        let t = (0..range.len())
            .find(|t| is_same(*t))
            .expect("a triangle of a light");
        // Barycentrics again, from the point alone and for the triangle as the mesh has it.
        let [a, b, c] = corners(t).map(|p| p.as_dvec3());
        let n = (b - a).cross(c - a);
        let part = |p: glam::DVec3, q: glam::DVec3| {
            (p - point.as_dvec3()).cross(q - point.as_dvec3()).dot(n) / n.dot(n)
        };
        let shares = [part(b, c), part(c, a), part(a, b)];
        counts[4 * t + shares.iter().position(|x| *x > 0.5).unwrap_or(3)] += 1;
    }
    for (i, patch) in lights.patches.iter().enumerate() {
        let samples = (SAMPLES - i).div_ceil(lights.patches.len()) as f64;
        let halves = [Some(patch.lower), patch.upper];
        let halves: Vec<_> = halves.into_iter().flatten().collect();
        for half in &halves {
            let is_same = |t: &usize| {
                half.iter()
                    .all(|v| geometry.triangles[range.start + t].contains(v))
            };
            let t = (0..range.len())
                .find(is_same)
                .expect("a triangle of a light");
            expected[4 * t..4 * t + 4]
                .iter_mut()
                .for_each(|e| *e += samples / halves.len() as f64 / 4.0);
        }
    }
    assert!(
        lights.patches.iter().any(|p| p.upper.is_none())
            && lights.patches.iter().any(|p| p.upper.is_some())
    );
    chi_squared("points", &counts, &expected);
}
