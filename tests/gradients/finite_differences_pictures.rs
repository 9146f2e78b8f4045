//! As `finite_differences`: the edges that pictures have.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use glam::{Affine2, Vec3, vec2, vec3};
use std::f32::consts::PI;
use warpath::scene::Distribution::Ggx;
use warpath::scene::{Layout, Scene};

fn moved(scene: &Scene, parts: &[(&str, &[f32])]) {
    check(scene, parts, 64, None, Fails);
}

#[test]
fn checkerboard_seen_directly() {
    let scene = close_up().constant_environment(SKY).checkerboard("floor");
    moved(&scene, &[("floor.translation", &[1.0, 0.4, 0.1])]);
    moved(&scene, &[("floor.rotation", &[0.1, 0.2, 1.0])]);
    moved(&scene, &[("cam.translation", &[1.0, 0.4, 0.1])]);
}

#[test]
fn checkerboard_with_a_shadow_on_it() {
    let scene = shadow().checkerboard("floor");
    moved(&scene, &[("floor.translation", &[1.0, 0.4, 0.1])]);
}

/// The block is seen in the floor and lights it.
#[test]
fn checkerboard_seen_in_reflections() {
    let metal = close_up()
        .constant_environment(SKY)
        .depth(3)
        .checkerboard("block");
    let metal = metal.metal("floor", 0.1, Ggx);
    moved(&metal, &[("block.rotation", &[0.1, 0.2, 1.0])]);
    let diffuse = close_up()
        .constant_environment(SKY)
        .depth(3)
        .checkerboard("block");
    moved(&diffuse, &[("block.rotation", &[0.1, 0.2, 1.0])]);
}

#[test]
fn texels_without_a_filter() {
    let scene = close_up()
        .constant_environment(SKY)
        .picture("floor")
        .unfiltered();
    moved(&scene, &[("floor.translation", &[1.0, 0.4, 0.1])]);
}

/// In a plane, where nothing but the picture jumps.
#[test]
fn pictures_that_do_not_fit_together() {
    let scene = close_up()
        .constant_environment(SKY)
        .picture("floor")
        .torn("floor");
    moved(&scene, &[("floor.translation", &[1.0, 0.4, 0.1])]);
    moved(&scene, &[("cam.rotation", &[0.1, 0.4, 0.3])]);
}

/// On a smooth ball, and in a plane, nothing but the colours jumps.
#[test]
fn faces_with_colours_of_their_own() {
    let scene = close_up().constant_environment(SKY).faces("floor");
    moved(&scene, &[("floor.translation", &[1.0, 0.4, 0.1])]);
    let ball = ball(1, vec3(0.2, 0.1, 0.5), 0.4);
    let scene = close_up().constant_environment(SKY);
    let scene = scene.smooth("ball", ball, [0.5; 3]).faces("ball");
    moved(&scene, &[("ball.rotation", &[0.1, 0.2, 1.0])]);
    let colours = vec![0.3; 3 * scene.meshes.last().expect("the ball").triangles.len()];
    check(&scene, &[("ball.face_color", &colours)], 64, None, Agrees);
}

/// On a smooth ball whose triangles share no vertices, nothing but the colours jumps.
#[test]
fn vertices_with_colours_that_are_not_shared() {
    let centre = vec3(0.2, 0.1, 0.5);
    let (positions, triangles) = ball(1, centre, 0.4);
    let corners = triangles.iter().flatten();
    let positions: Vec<_> = corners.map(|&v| positions[v as usize]).collect();
    let normals = positions.iter().map(|p| (p - centre).normalize()).collect();
    let triangles = (0..positions.len() as u32 / 3).map(|t| [0, 1, 2].map(|i| 3 * t + i));
    let shape = (positions, triangles.collect());
    let scene = close_up().constant_environment(SKY);
    let mut scene = scene
        .with_normals("ball", shape, normals, [0.5; 3])
        .faces("ball");
    let mut textures = scene.textures.iter_mut();
    let texture = textures.find(|t| t.layout == Layout::Faces).expect("it");
    texture.layout = Layout::Vertices;
    texture.texels = texture
        .texels
        .iter()
        .flat_map(|&texel| [texel; 3])
        .collect();
    moved(&scene, &[("ball.rotation", &[0.1, 0.2, 1.0])]);
}

/// Nothing but a ball whose colour changes at its equator, along which its facets meet.
#[test]
fn a_picture_that_jumps_where_facets_meet() {
    const ROWS: u32 = 8;
    const SECTORS: u32 = 2 * ROWS;
    let point = |i: u32| {
        let [row, sector] = [i / SECTORS, i % SECTORS].map(|n| n as f32 * PI / ROWS as f32);
        let (sine, cosine) = row.sin_cos();
        vec3(sine * sector.cos(), sine * sector.sin(), cosine)
    };
    let quad = |i: u32| {
        let right = i / SECTORS * SECTORS + (i + 1) % SECTORS;
        [
            [i, i + SECTORS, right],
            [right, i + SECTORS, right + SECTORS],
        ]
    };
    // The poles would have triangles without an area.
    let inner = SECTORS..(ROWS - 1) * SECTORS;
    let positions: Vec<_> = (0..ROWS * SECTORS).map(point).collect();
    let shape = (positions, inner.flat_map(quad).collect());
    let scene = scene(vec3(0.2, -3.0, 0.3), Vec3::ZERO, 12.0, [8; 2], GAUSSIAN);
    let scene = scene.constant_environment(SKY).depth(2);
    let mut scene = scene.smooth("ball", shape, [0.5; 3]).checkerboard("ball");
    let ball = scene.meshes.last_mut().expect("the ball");
    let uv = |i: u32| vec2(0.1, (i / SECTORS) as f32 / ROWS as f32);
    ball.uvs = (0..ROWS * SECTORS).map(uv).collect();
    let mut textures = scene.textures.iter_mut();
    let board = textures.find(|t| matches!(t.layout, Layout::Checkerboard { .. }));
    board.expect("it").layout = Layout::Checkerboard {
        to_uv: Affine2::IDENTITY,
    };
    moved(&scene, &[("ball.translation", &[0.3, 0.4, 1.0])]);
}
