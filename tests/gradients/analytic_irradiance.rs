//! Gradients of irradiance against closed forms: polygons, half hidden polygons, discs and spheres.
//!
//! A camera with a very narrow field of view looks at the origin of a diffuse floor, so that the
//! image is ρ/π·E(0), up to terms of second order in the picked spot's width (1e-4 here), and E has
//! closed forms.

use common::scenes::*;
use common::shapes::Shape;
use common::statistics::Estimate;
use common::{direction, gradient, settings};
use glam::{DQuat, DVec3, Vec3, dvec3, vec3};
use std::f64::consts::PI;
use warpath::methods::Method;
use warpath::scene::Scene;

const RUNS: u64 = 16;
const SIGMAS: f64 = 4.0;
/// Standard errors are no more than this part of what they belong to.
const RESOLUTION: f64 = 0.01;
const REFLECTANCE: f64 = 0.6;
const RADIANCE: f64 = 5.0;

/// A floor whose origin fills the film.
fn spot() -> Scene {
    scene(vec3(2.0, -1.0, 0.7), Vec3::ZERO, 0.01, [2; 2], BOX).solid(
        "floor",
        floor(1.0, 0.0),
        [REFLECTANCE as f32; 3],
    )
}

/// The derivative of the irradiance at the origin.
fn derivative_of_irradiance(scene: &Scene, key: &str, values: &[f32], spp: u32) -> Estimate {
    let along = direction(scene, &[(key, values)]);
    let run = |seed| {
        let image = gradient(scene, &settings(scene, Method::Reparam, spp, seed), &along);
        image.iter().sum::<f64>() / image.len() as f64 * PI / REFLECTANCE
    };
    Estimate::mean(&(1..=RUNS).map(run).collect::<Vec<_>>())
}

/// Within four standard errors, which are small.
fn assert_is(what: &str, estimate: Estimate, truth: f64) {
    println!(
        "{what}: {estimate:?}, truth {truth}, z {:.1}",
        estimate.z(truth)
    );
    assert!(
        estimate.error <= RESOLUTION * truth.abs(),
        "{what}: {estimate:?} says nothing about {truth}"
    );
    // Where every sample is exact, single precision and the spot's width are left.
    let error = estimate.error.max(1e-4 * truth.abs());
    assert!(
        (estimate.value - truth).abs() <= SIGMAS * error,
        "{what}: {estimate:?}, truth {truth}"
    );
}

/// Central difference of order 4.
fn derivative(of: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-3;
    (of(-2.0 * h) - 8.0 * of(-h) + 8.0 * of(h) - of(2.0 * h)) / (12.0 * h)
}

/// Lambert's formula: a polygon of radiance L above the horizon gives a floor at the origin (normal
/// +z) the irradiance E = L/2·Σ Γ_i·z, where Γ_i has the length of the angle between the directions
/// to two neighbouring corners and stands on both. Corners run so that E is positive from below.
fn polygon(corners: &[DVec3]) -> f64 {
    let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
    let sum: f64 = pairs
        .map(|(a, b)| {
            let (a, b) = (a.normalize(), b.normalize());
            let cross = a.cross(b);
            cross.length().atan2(a.dot(b)) * cross.normalize_or_zero().z
        })
        .sum();
    RADIANCE / 2.0 * sum.abs()
}

/// The part of a polygon on the side of the plane through the origin to which `normal` points.
fn clipped(corners: &[DVec3], normal: DVec3) -> Vec<DVec3> {
    let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
    pairs
        .flat_map(|(a, b)| {
            let (at_a, at_b) = (a.dot(normal), b.dot(normal));
            let crossing = ((at_a > 0.0) != (at_b > 0.0)).then(|| a.lerp(*b, at_a / (at_a - at_b)));
            (at_a > 0.0).then_some(*a).into_iter().chain(crossing)
        })
        .collect()
}

/// A light askew, as corners and as a shape that shines down.
fn lamp() -> (Vec<DVec3>, Shape) {
    let (corner, u, v) = (
        vec3(-0.5, -0.3, 1.5),
        vec3(0.2, 0.9, 0.1),
        vec3(1.0, 0.1, 0.3),
    );
    let shape = parallelogram(corner, u, v);
    (shape.0.iter().map(|p| p.as_dvec3()).collect(), shape)
}

fn centre(corners: &[DVec3]) -> DVec3 {
    let low = corners.iter().copied().reduce(DVec3::min).expect("corners");
    let high = corners.iter().copied().reduce(DVec3::max).expect("corners");
    (low + high) / 2.0
}

fn moved(corners: &[DVec3], motion: impl Fn(DVec3) -> DVec3) -> Vec<DVec3> {
    corners.iter().map(|p| motion(*p)).collect()
}

#[test]
fn a_polygon_that_moves() {
    let (corners, shape) = lamp();
    let scene = spot().light("lamp", shape, [RADIANCE as f32; 3]);
    let along = dvec3(0.3, 0.5, 1.0);
    let translated = derivative(|t| polygon(&moved(&corners, |p| p + t * along)));
    assert_is(
        "translation",
        derivative_of_irradiance(&scene, "lamp.translation", &[0.3, 0.5, 1.0], 256),
        translated,
    );
    let c = centre(&corners);
    let turned = derivative(|t| {
        polygon(&moved(&corners, |p| {
            c + DQuat::from_rotation_y(t) * (p - c)
        }))
    });
    assert_is(
        "rotation",
        derivative_of_irradiance(&scene, "lamp.rotation", &[0.0, 1.0, 0.0], 256),
        turned,
    );
    let grown = derivative(|t| polygon(&moved(&corners, |p| c + (1.0 + t) * (p - c))));
    assert_is(
        "scale",
        derivative_of_irradiance(&scene, "lamp.scale", &[1.0], 256),
        grown,
    );
}

/// A half-plane hides what lies on one side of the plane through the floor's point and its edge.
#[test]
fn a_polygon_behind_a_half_plane() {
    let (corners, shape) = lamp();
    let (at, along) = (dvec3(0.05, 0.0, 0.6), dvec3(0.3, 1.0, 0.1));
    let side = dvec3(-1.0, 0.2, 0.1);
    let blocker = parallelogram(
        (at - 5.0 * along).as_vec3(),
        10.0 * along.as_vec3(),
        5.0 * side.as_vec3(),
    );
    let scene = spot().light("lamp", shape, [RADIANCE as f32; 3]).solid(
        "blocker",
        blocker.clone(),
        [0.0; 3],
    );
    let visible = |at: DVec3, along: DVec3| {
        let normal = at.cross(along);
        polygon(&clipped(
            &corners,
            if normal.dot(at + side) > 0.0 {
                -normal
            } else {
                normal
            },
        ))
    };
    assert!(
        visible(at, along) > 0.2 * polygon(&corners)
            && visible(at, along) < 0.8 * polygon(&corners)
    );
    let shift = dvec3(1.0, 0.3, 0.2);
    let translated = derivative(|t| visible(at + t * shift, along));
    assert_is(
        "translation",
        derivative_of_irradiance(&scene, "blocker.translation", &[1.0, 0.3, 0.2], 256),
        translated,
    );
    let c = centre(&blocker.0.iter().map(|p| p.as_dvec3()).collect::<Vec<_>>());
    let turned = derivative(|t| {
        let turn = DQuat::from_rotation_z(t);
        visible(c + turn * (at - c), turn * along)
    });
    assert_is(
        "rotation",
        derivative_of_irradiance(&scene, "blocker.rotation", &[0.0, 0.0, 1.0], 256),
        turned,
    );
    let grown = derivative(|t| visible(c + (1.0 + t) * (at - c), along));
    assert_is(
        "scale",
        derivative_of_irradiance(&scene, "blocker.scale", &[1.0], 256),
        grown,
    );
    // The light moves behind the edge.
    let behind = derivative(|t| {
        let normal = at.cross(along);
        let normal = if normal.dot(at + side) > 0.0 {
            -normal
        } else {
            normal
        };
        polygon(&clipped(&moved(&corners, |p| p + t * shift), normal))
    });
    assert_is(
        "light",
        derivative_of_irradiance(&scene, "lamp.translation", &[1.0, 0.3, 0.2], 256),
        behind,
    );
}

// A disc of radius r at the height h above the spot, parallel to the floor: its form factor is F =
// r²/(r² + h²). With s = r/r₀ the scale, dF/ds = 2r²h²/(r² + h²)², and dF/dh = −2r²h/(r² + h²)². A
// regular polygon of n corners has 2π²/3n² less area, 2e-5 for 600: far below what is resolved.

const RADIUS: f64 = 0.7;
const HEIGHT: f64 = 0.9;
const CORNERS: u32 = 600;

fn disc_derivatives(radius: f64) -> [f64; 2] {
    let square = radius * radius + HEIGHT * HEIGHT;
    let common = 2.0 * radius * radius * HEIGHT / (square * square);
    [common * HEIGHT, -common]
}

#[test]
fn a_disc_that_shines() {
    let shape = disc(
        vec3(0.0, 0.0, HEIGHT as f32),
        Vec3::NEG_Z,
        RADIUS as f32,
        CORNERS,
    );
    let scene = spot().light("disc", shape, [RADIANCE as f32; 3]);
    let [by_scale, by_height] = disc_derivatives(RADIUS).map(|d| PI * RADIANCE * d);
    assert_is(
        "scale",
        derivative_of_irradiance(&scene, "disc.scale", &[1.0], 256),
        by_scale,
    );
    assert_is(
        "height",
        derivative_of_irradiance(&scene, "disc.translation", &[0.0, 0.0, 1.0], 256),
        by_height,
    );
    let by_floor = derivative_of_irradiance(&scene, "floor.translation", &[0.0, 0.0, 1.0], 1024);
    assert_is("floor's height", by_floor, -by_height);
}

// A sphere of radius r at the distance d in a direction of cosine c gives E = πL·c·(r/d)², if all
// of it stands above the horizon. An inscribed polyhedron of the same corners gives a little less:
// exactly the sum of Lambert's formula over the triangles that face the spot, which hide nothing of
// each other as it is convex.

fn polyhedron((positions, triangles): &Shape, motion: impl Fn(DVec3) -> DVec3) -> f64 {
    let facing = triangles
        .iter()
        .map(|t| t.map(|v| motion(positions[v as usize].as_dvec3())));
    facing
        .filter(|[a, b, c]| a.dot((*b - *a).cross(*c - *a)) < 0.0)
        .map(|t| polygon(&t))
        .sum()
}

#[test]
fn a_sphere_that_shines() {
    let at = dvec3(0.5, 0.3, 1.4);
    let radius = 0.5;
    let shape = ball(3, at.as_vec3(), radius as f32);
    let scene = spot().light("ball", shape.clone(), [RADIANCE as f32; 3]);
    let formula =
        |at: DVec3, r: f64| PI * RADIANCE * at.z / at.length() * (r * r / at.length_squared());
    let exact = polyhedron(&shape, |p| p);
    assert!(
        (exact / formula(at, radius) - 1.0).abs() < 0.01,
        "{exact} is no sphere's"
    );

    let by_scale = derivative(|t| polyhedron(&shape, |p| at + (1.0 + t) * (p - at)));
    let of_sphere = derivative(|t| formula(at, radius * (1.0 + t)));
    assert!((by_scale / of_sphere - 1.0).abs() < 0.01);
    assert_is(
        "radius",
        derivative_of_irradiance(&scene, "ball.scale", &[1.0], 1024),
        by_scale,
    );

    let away = at.normalize();
    let by_distance = derivative(|t| polyhedron(&shape, |p| p + t * away));
    let of_sphere = derivative(|t| formula(at + t * away, radius));
    assert!((by_distance / of_sphere - 1.0).abs() < 0.01);
    let values = away.as_vec3().to_array();
    assert_is(
        "distance",
        derivative_of_irradiance(&scene, "ball.translation", &values, 1024),
        by_distance,
    );
}

/// The sky gives πL, less what the disc hides. Small discs fall between the points at which a
/// vertex looks at the sky.
#[test]
fn discs_before_the_sky() {
    for (radius, spp) in [(0.7, 1024), (0.35, 1024), (0.0875, 8192)] {
        let shape = disc(
            vec3(0.0, 0.0, HEIGHT as f32),
            Vec3::NEG_Z,
            radius as f32,
            CORNERS,
        );
        let scene = spot()
            .constant_environment([RADIANCE as f32; 3])
            .solid("disc", shape, [0.0; 3]);
        let [by_scale, by_height] = disc_derivatives(radius).map(|d| -PI * RADIANCE * d);
        assert_is(
            &format!("scale at radius {radius}"),
            derivative_of_irradiance(&scene, "disc.scale", &[1.0], spp),
            by_scale,
        );
        assert_is(
            &format!("height at radius {radius}"),
            derivative_of_irradiance(&scene, "disc.translation", &[0.0, 0.0, 1.0], spp),
            by_height,
        );
    }
}
