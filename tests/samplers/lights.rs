//! Points of area lights.

use super::*;
use common::scenes::*;
use glam::{Vec3, vec3};
use warpath::lanes::Lane;
use warpath::paths::light::patches::Lights;
use warpath::scene::Scene;
use warpath::trace::geometry::Geometry;

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

/// A light is one thing if it is round, of one piece, closed, and shines outward; and each of its
/// points has the place on its patch that the patch says.
#[test]
fn round_lights_are_lamps() {
    let body = || ball(2, vec3(0.1, 0.2, 3.0), 0.4);
    let stretched = |(mut positions, triangles): (Vec<Vec3>, Vec<[u32; 3]>)| {
        positions.iter_mut().for_each(|p| p.x *= 2.0);
        (positions, triangles)
    };
    let (positions, triangles) = body();
    let inward = triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
    let open = triangles[1..].to_vec();
    let mut two = body();
    let far = positions.iter().map(|&p| p + vec3(2.0, 0.0, 0.0));
    let first = positions.len() as u32;
    two.0.extend(far.collect::<Vec<_>>());
    two.1.extend(triangles.iter().map(|t| t.map(|v| v + first)));
    let shapes = [
        (body(), true),
        (ball(1, vec3(0.1, 0.2, 3.0), 0.4), false),
        (stretched(body()), false),
        ((positions.clone(), inward), false),
        ((positions, open), false),
        (two, false),
        (spiky(vec3(0.1, 0.2, 3.0), 0.4, [1.2, 0.8]), false),
    ];
    for (shape, is_lamp) in shapes {
        let scene = scene(vec3(0.0, -4.0, 2.0), Vec3::ZERO, 40.0, [4; 2], BOX);
        let scene = scene.light("lamp", shape, [1.0; 3]);
        let geometry = Geometry::new(&scene);
        let lights = Lights::new(&scene, &geometry, false);
        assert_eq!(lights.lamps[0].is_some(), is_lamp);
        let Some(lamp) = &lights.lamps[0] else {
            continue;
        };
        assert!((lamp.chance - 1.0).abs() < 1e-6, "{}", lamp.chance);
        for (number, patch) in lights.patches.iter().enumerate() {
            for (s, r) in [(0.2, 0.3), (0.7, 0.1)] {
                let (triangle, b) = patch.triangle_at(s, r);
                assert_eq!(lamp.patch(triangle), Some(number as u32));
                let place = patch.place_on(triangle, b.map(f64::from));
                let error = (place[0] - f64::from(s)).hypot(place[1] - f64::from(r));
                assert!(error < 1e-6, "{place:?} for {s}, {r}");
            }
        }
    }
}
