//! As `finite_differences`: the edges that pictures have.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use glam::vec3;
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
