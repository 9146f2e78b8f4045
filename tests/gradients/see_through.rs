//! What moves behind masks and thin panes: against finite differences, and the other sweep.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Affine2, Vec2, Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{Layout, Scene, Wrap};

const MOVED: [f32; 3] = [1.0, 0.0, 0.2];
/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);

fn checked(scene: &Scene, spp: u32, key: &str, resolution: f64) {
    println!("{key}");
    check_to(resolution, scene, &[(key, &MOVED)], spp, STEP, Fails);
}

/// A black plate before the sky, behind a sheet.
fn behind_a_sheet() -> Scene {
    let plate = parallelogram(vec3(-0.7, 1.0, -0.4), Vec3::X * 0.9, Vec3::Z * 0.9);
    let sheet = parallelogram(vec3(-0.5, -0.6, -0.5), Vec3::X, Vec3::Z);
    scene(
        vec3(0.3, -3.4, 0.9),
        vec3(0.0, 0.0, 0.0),
        22.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("sheet", sheet, [0.2, 0.3, 0.1])
    .solid("plate", plate, [0.0; 3])
    .constant_environment(SKY)
    .depth(2)
}

/// Has a mask's opacity vary between nothing and all over x and z.
fn cut_out(mut scene: Scene, id: &str, bilinear: bool) -> Scene {
    let mesh = scene.meshes.iter_mut().find(|m| m.id == id);
    let mesh = mesh.expect("a mesh");
    mesh.uvs = mesh
        .positions
        .iter()
        .map(|p| glam::vec2(p.x, p.z))
        .collect();
    let key = format!("{id}.bsdf.opacity");
    let opacity = scene.textures.iter_mut().find(|t| t.key == key);
    let opacity = opacity.expect("an opacity");
    let holes = [1, 0, 1, 1, 0, 1, 0, 0, 0, 1, 1, 0];
    opacity.texels = holes.map(|o| [o as f32; 3]).to_vec();
    opacity.layout = Layout::Bitmap {
        width: 4,
        height: 3,
        wrap: Wrap::Repeat,
        bilinear,
        to_uv: Affine2::IDENTITY,
    };
    scene
}

#[test]
fn behind_a_pane() {
    let scene = behind_a_sheet().pane("sheet");
    checked(&scene, 256, "plate.translation", 0.02);
    checked(&scene, 256, "sheet.translation", 0.05);
    checked(&scene, 256, "cam.translation", 0.02);
}

#[test]
fn behind_a_mask() {
    let scene = behind_a_sheet().masked("sheet", 0.4);
    checked(&scene, 256, "plate.translation", 0.03);
    checked(&scene, 256, "sheet.translation", 0.03);
    checked(&scene, 256, "cam.translation", 0.02);
}

#[test]
fn behind_a_soft_cut_out() {
    let scene = cut_out(behind_a_sheet().masked("sheet", 0.4), "sheet", true);
    checked(&scene, 256, "plate.translation", 0.03);
    checked(&scene, 256, "sheet.translation", 0.03);
    checked(&scene, 256, "cam.translation", 0.02);
}

#[test]
fn behind_a_sharp_cut_out() {
    let scene = cut_out(behind_a_sheet().masked("sheet", 0.4), "sheet", false);
    checked(&scene, 256, "plate.translation", 0.03);
    // At the usual step differences are off by a hundredth: edges pass behind edges.
    let moved = [("sheet.translation", MOVED.as_slice())];
    check_to(0.03, &scene, &moved, 256, Some(0.004), Fails);
    checked(&scene, 256, "cam.translation", 0.02);
}

/// Seen along bounces, too.
#[test]
fn a_body_of_panes_or_masks() {
    let scene = close_up().constant_environment(SKY).depth(3);
    for scene in [scene.clone().pane("block"), scene.masked("block", 0.4)] {
        checked(&scene, 256, "block.translation", 0.03);
        checked(&scene, 256, "cam.translation", 0.02);
    }
}

/// A body of six sides that are cut out like a checkerboard, whose lines run along the body's
/// edges: seen through its holes an edge was once found with each of the lines, and counted as
/// often.
#[test]
fn edges_with_lines_along_them() {
    let (corners, triangles) = placed(
        cuboid(Vec3::splat(0.6)),
        vec3(0.0, 0.0, 25.0),
        vec3(0.0, 0.0, 0.8),
    );
    let sides = triangles
        .chunks(2)
        .map(|side| [side[0][0], side[0][1], side[0][2], side[1][2]]);
    let sides: Vec<Vec3> = sides.flatten().map(|i| corners[i as usize]).collect();
    let fans = (0..6).flat_map(|side| [[0, 1, 2], [0, 2, 3]].map(|t| t.map(|i| 4 * side + i)));
    let mut scene = scene(
        vec3(1.0, -6.0, 3.0),
        vec3(0.0, 0.0, 0.7),
        24.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("block", (sides, fans.collect()), [0.1; 3])
    .masked("block", 1.0)
    .constant_environment(SKY)
    .depth(4);
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from);
    scene.meshes[0].uvs = (0..6).flat_map(|_| square).collect();
    let opacity = scene
        .textures
        .iter_mut()
        .find(|t| t.key == "block.bsdf.opacity");
    let opacity = opacity.expect("an opacity");
    opacity.texels = vec![[1.0; 3], [0.0; 3]];
    opacity.layout = Layout::Checkerboard {
        to_uv: Affine2::IDENTITY,
    };
    checked(&scene, 256, "block.rotation", 0.03);
}

#[test]
fn transposition() {
    let block = |at: Vec3| placed(cuboid(Vec3::splat(0.25)), vec3(10.0, 20.0, 30.0), at);
    let scene = scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        GAUSSIAN,
    )
    .solid("floor", floor(1.5, 0.0), [0.5; 3])
    .solid("pane", block(vec3(-0.6, -0.4, 0.4)), [0.5; 3])
    .smooth("mask", ball(2, vec3(-0.2, -0.8, 0.5), 0.3), [0.5; 3])
    .solid("leaf", block(vec3(0.9, 0.8, 0.3)), [0.5; 3])
    .light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
    .constant_environment(SKY)
    .pane("pane")
    .masked("mask", 0.4)
    .masked("leaf", 0.4)
    .depth(4);
    let idle = ["pane", "lamp"].map(|id| format!("{id}.bsdf.brdf_0.reflectance.value"));
    let idle: Vec<&str> = idle.iter().map(String::as_str).collect();
    transposed(&cut_out(scene, "leaf", true), Method::Reparam, &idle);
}

/// Rays start a little off surfaces, and beside where a plate passes through a mask they once
/// started beyond both: the sky was seen there.
#[test]
fn what_passes_through_a_mask() {
    let pane = parallelogram(vec3(-0.6, -0.5, -0.6), Vec3::X * 1.2, Vec3::Z * 1.2);
    let sheet = parallelogram(vec3(-0.5, 0.4, -0.5), Vec3::X, Vec3::Z);
    let plate = parallelogram(vec3(-0.4, 0.2, -0.4), Vec3::X * 0.8, vec3(0.0, 0.5, 0.8));
    let scene = behind_a_sheet();
    let mut scene = scene.depth(4);
    scene.meshes.clear();
    let scene = scene
        .solid("pane", pane, [0.5; 3])
        .solid("through", sheet, [0.0; 3])
        .solid("black", plate, [0.0; 3])
        .null("pane")
        .masked("through", 0.5);
    let by = [("through.translation", [0.6, 0.5, 0.2].as_slice())];
    check_to(0.02, &scene, &by, 256, STEP, Fails);
}
