//! A sheet that shows both of its sides in a mirror: behind one fold of it lies another part of it.

use crate::chains::lossless;
use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::Shape;
use common::statistics::Agreement;
use common::{direction, gradient, settings};
use glam::{Vec3, vec2, vec3};
use std::f32::consts::TAU;
use warpath::methods::Method;
use warpath::scene::Scene;

const SECTORS: u32 = 48;

/// A tube without lids, about an axis askew.
fn tube() -> Shape {
    let at = |i: u32| {
        let angle = i as f32 / SECTORS as f32 * TAU;
        vec3(0.35 * angle.cos(), 0.35 * angle.sin(), 0.0)
    };
    let ring = |z| (0..SECTORS).map(move |i| at(i) + Vec3::Z * z);
    let quad = |i| {
        let (j, n) = ((i + 1) % SECTORS, SECTORS);
        [[i, j, j + n], [i, j + n, i + n]]
    };
    let positions = ring(-0.3).chain(ring(0.3)).collect();
    let triangles = (0..SECTORS).flat_map(quad).collect();
    placed(
        (positions, triangles),
        vec3(68.0, 0.0, 50.0),
        vec3(0.1, 1.0, 0.8),
    )
}

fn upside_down((positions, triangles): Shape) -> Shape {
    let positions = positions.into_iter().map(|p| vec3(p.x, p.y, -p.z));
    (positions.collect(), triangles)
}

/// Its picture in the floor, and no more.
fn seen() -> Scene {
    scene(
        vec3(0.3, -3.4, 1.9),
        vec3(0.1, 1.0, -0.8),
        17.0,
        [16; 2],
        GAUSSIAN,
    )
    .constant_environment(SKY)
    .depth(2)
}

/// Of what is thin there much is found from beyond it, and all of that was once taken to be rare.
#[test]
fn corners_of_a_tube() {
    let floor = floor(3.0, 0.0);
    let folded = lossless(
        seen().solid("floor", floor, [0.5; 3]).mirror("floor"),
        "floor",
    );
    let folded = folded.smooth("tube", tube(), [0.0; 3]);
    let unfolded = seen().smooth("tube", upside_down(tube()), [0.0; 3]);
    let runs = |scene: &Scene, by: [f32; 3], first: u64| -> Vec<Vec<f64>> {
        let along = direction(scene, &[("tube.translation", &by)]);
        let one = |seed| gradient(scene, &settings(scene, Method::Reparam, 16, seed), &along);
        (first..first + 24).map(one).collect()
    };
    let ours = Agreement::new(
        &runs(&folded, [0.7, 0.9, 0.6], 1),
        &runs(&unfolded, [0.7, 0.9, -0.6], 1000),
    );
    println!("{ours:.4?}");
    assert!(ours.bias.error < 0.005, "{ours:.4?}");
    assert!(ours.holds(4.0), "{ours:.4?}");
}

/// Edges of a picture in a cell with an outline count once.
#[test]
fn stripes_of_a_tube() {
    let scene = seen().depth(3).solid("floor", floor(3.0, 0.0), [0.5; 3]);
    let scene = scene.mirror("floor").smooth("tube", tube(), [0.5; 3]);
    let mut scene = scene.checkerboard("tube");
    let tube = scene.meshes.last_mut().expect("the tube");
    let around = |i: usize| 3.0 * (i as u32 % SECTORS) as f32 / SECTORS as f32;
    let uv = |i| vec2(around(i), (i as u32 / SECTORS) as f32);
    tube.uvs = (0..tube.positions.len()).map(uv).collect();
    let parts = [("tube.translation", [0.7, 0.9, 0.6].as_slice())];
    check_to(0.02, &scene, &parts, 256, None, Fails);
}
