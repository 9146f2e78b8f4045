//! What is seen through smooth surfaces whose normals a picture turns: against finite differences,
//! and the other sweep.

use crate::chains::{ball_before_a_plate, over_a_mirror};
use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{Layout, Scene};

const MOVED: [f32; 3] = [1.0, 0.0, 0.2];
/// World units: a tenth of a pixel.
const STEP: Option<f64> = Some(0.01);
/// Of texels. Normals turn what is seen by twice as much, and with 0.01 differences are off by 3 %.
const FINE_STEP: Option<f64> = Some(0.0025);

fn checked(scene: &Scene, spp: u32, key: &str, by: &[f32], resolution: f64) {
    println!("{key}");
    let step = if key.ends_with("data") {
        FINE_STEP
    } else {
        STEP
    };
    check_to(resolution, scene, &[(key, by)], spp, step, Fails);
}

#[test]
fn a_mirror_with_a_map_of_normals() {
    let scene = over_a_mirror().relief("floor", None);
    checked(&scene, 256, "plate.translation", &MOVED, 0.03);
    checked(&scene, 256, "floor.translation", &[1.0, 0.4, 0.1], 0.03);
    checked(&scene, 256, "floor.rotation", &[0.5, 0.3, 0.0], 0.03);
    checked(&scene, 256, "cam.translation", &MOVED, 0.03);
    checked(
        &scene,
        256,
        "floor.bsdf.normalmap.data",
        &[1.0, 0.5, 0.2],
        0.03,
    );
}

/// Bumps bend what is seen where the slopes of their picture jump.
#[test]
fn a_mirror_with_bumps() {
    let scene = over_a_mirror().relief("floor", Some(0.1));
    checked(&scene, 256, "plate.translation", &MOVED, 0.03);
    checked(&scene, 256, "floor.translation", &[1.0, 0.4, 0.1], 0.03);
    let heights: Vec<f32> = (0..20).map(|i| (i as f32 * 0.9).cos()).collect();
    checked(
        &scene,
        256,
        "floor.bsdf.nested_texture.data",
        &heights,
        0.03,
    );
}

/// The normals of each texel are its own.
#[test]
fn a_mirror_of_tiles() {
    let scene = over_a_mirror().relief("floor", None).unfiltered();
    checked(&scene, 256, "plate.translation", &MOVED, 0.03);
    checked(&scene, 256, "floor.translation", &[1.0, 0.4, 0.1], 0.03);
}

#[test]
fn glass_and_plastic() {
    let scene = close_up().constant_environment(SKY).depth(5);
    let glass = scene.clone().clear("block").relief("block", None);
    checked(&glass, 256, "block.translation", &MOVED, 0.03);
    let plastic = scene.plastic("floor", None).relief("floor", None);
    checked(&plastic, 256, "block.translation", &MOVED, 0.03);
}

/// At grazing angles normals that look away are turned round, and the border of that is not
/// followed: these do so hardly.
fn flattened(mut scene: Scene) -> Scene {
    if let Some(texture) = scene.textures.last_mut() {
        for [x, y, _] in &mut texture.texels {
            (*x, *y) = (0.35 + 0.3 * *x, 0.35 + 0.3 * *y);
        }
    }
    scene
}

#[test]
fn a_curved_mirror() {
    let scene = ball_before_a_plate().depth(2).mirror("ball");
    let scene = flattened(scene.relief("ball", None));
    checked(&scene, 1024, "near.translation", &MOVED, 0.04);
    checked(&scene, 256, "ball.translation", &MOVED, 0.01);
}

/// On a coarse ball the axes about which normals turn are others on each triangle, of whatever it
/// is made.
#[test]
fn axes_jump_from_facet_to_facet() {
    let mut scene = ball_before_a_plate().depth(2);
    scene.meshes.retain(|m| m.id != "ball");
    let scene = scene.smooth("ball", ball(1, Vec3::ZERO, 0.5), [0.5; 3]);
    let mut scene = scene.relief("ball", None);
    if let Some(texture) = scene.textures.last_mut() {
        texture.texels.fill([0.55, 0.45, 0.95]);
    }
    checked(&scene, 1024, "ball.translation", &MOVED, 0.0025);
}

/// Normals that vary between vertices slide under a pixel as the ball moves.
#[test]
fn normals_by_vertex() {
    let mut scene = ball_before_a_plate().depth(2).relief("ball", None);
    let ball = scene.meshes.iter().find(|m| m.id == "ball");
    let wave = |p: &Vec3| [0.3 * (9.0 * p.x).sin(), 0.25 * (11.0 * p.z).cos(), 0.4];
    let normals = ball.map(|b| b.positions.iter().map(wave).collect::<Vec<_>>());
    if let (Some(texture), Some(normals)) = (scene.textures.last_mut(), normals) {
        texture.texels = normals.iter().map(|n| n.map(|x| 0.5 + x)).collect();
        texture.layout = Layout::Vertices;
        texture.key = "ball.vertex_slopes".into();
    }
    checked(&scene, 256, "ball.translation", &MOVED, 0.02);
}

#[test]
fn transposition() {
    let scene = scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        GAUSSIAN,
    )
    .solid("floor", floor(1.5, 0.0), [0.5; 3])
    .smooth("mirror", ball(2, vec3(0.5, -0.1, 0.4), 0.35), [0.5; 3])
    .smooth("glass", ball(2, vec3(-0.2, -0.8, 0.5), 0.3), [0.5; 3])
    .light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
    .constant_environment(SKY)
    .mirror("mirror")
    .clear("glass")
    .relief("mirror", Some(0.1))
    .relief("glass", None)
    .depth(4);
    let painted = ["mirror", "glass", "lamp"];
    let idle = painted.map(|id| format!("{id}.bsdf.brdf_0.reflectance.value"));
    let idle: Vec<&str> = idle.iter().map(String::as_str).collect();
    transposed(&scene, Method::Reparam, &idle);
}
