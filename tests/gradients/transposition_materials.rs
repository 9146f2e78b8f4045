//! As `transposition`: every kind of surface, texture and light, and every parameter of each.

use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use glam::{Mat3, Vec3, vec2, vec3};
use warpath::methods::Method;
use warpath::scene::Distribution::{Beckmann, Ggx};
use warpath::scene::{Beam, BeamProfile, DeltaLight, DeltaLightKind, Scene, Texture};

/// A black lamp out of sight, whose own colour does not matter, and the colours that have been
/// painted over.
const IDLE: &[&str] = &[
    "lamp.bsdf.brdf_0.reflectance.value",
    "floor.bsdf.brdf_0.reflectance.value",
    "wedge.bsdf.brdf_0.reflectance.value",
    "narrow.bsdf.brdf_0.reflectance.value",
    "wide.bsdf.brdf_0.reflectance.value",
    "glass.bsdf.brdf_0.reflectance.value",
    "plastic.bsdf.brdf_0.reflectance.value",
];

/// The same of [`layered`], and what lies under a blend of its own metal or a pane.
const IDLE_LAYERS: &[&str] = &[
    "lamp.bsdf.brdf_0.reflectance.value",
    "floor.bsdf.brdf_0.reflectance.value",
    "narrow.bsdf.brdf_0.reflectance.value",
    "wide.bsdf.brdf_0.reflectance.value",
    "glass.bsdf.brdf_0.reflectance.value",
    "plastic.bsdf.brdf_0.reflectance.value",
    "narrow.bsdf.alpha.value",
    "glass.bsdf.alpha.value",
];

/// Narrow and wide metal, rough glass, plastic (smooth if none is given), pictures, the sun and a
/// lamp.
fn materials(depth: u32, plastic_alpha: Option<f32>) -> Scene {
    let block = |at: Vec3| placed(cuboid(Vec3::splat(0.25)), vec3(10.0, 20.0, 30.0), at);
    scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        GAUSSIAN,
    )
    .depth(depth)
    .solid("floor", floor(1.5, 0.0), [0.5; 3])
    .smooth("narrow", ball(2, vec3(0.5, -0.1, 0.4), 0.35), [0.5; 3])
    .solid("wide", block(vec3(-0.6, 0.4, 0.4)), [0.5; 3])
    .solid("glass", block(vec3(-0.2, -0.8, 0.5)), [0.5; 3])
    .smooth("plastic", ball(1, vec3(-0.9, -0.5, 0.3), 0.3), [0.5; 3])
    .smooth("wedge", block(vec3(0.9, 0.8, 0.3)), [0.5; 3])
    .light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
    .checkerboard("floor")
    .picture("wedge")
    .metal("narrow", 0.1, Ggx)
    .metal("wide", 0.3, Beckmann)
    .glass("glass", 0.12)
    .plastic("plastic", plastic_alpha)
    .sunny()
}

/// With a point light, whose position can be differentiated where edges are ignored.
fn with_a_bulb(mut scene: Scene) -> Scene {
    scene.delta_lights.push(DeltaLight {
        key: "bulb".into(),
        kind: DeltaLightKind::Point {
            position: vec3(0.8, -0.9, 1.6),
        },
        power: scene.textures.len(),
        beam: None,
    });
    scene
        .textures
        .push(Texture::constant("bulb.intensity".into(), [2.0, 1.5, 1.0]));
    scene
}

/// With a spot that has a picture, and a projector.
fn with_beams(mut scene: Scene) -> Scene {
    let picture = scene.clone().picture("floor").textures.pop().expect("one");
    let slide = scene.textures.len();
    for key in ["slide", "projector.irradiance"] {
        let key = key.to_string();
        scene.textures.push(Texture {
            key,
            ..picture.clone()
        });
    }
    let to_local = |x: f32, y: f32| Mat3::from_rotation_y(y) * Mat3::from_rotation_x(x);
    let spot = BeamProfile::Spot {
        beam_width_rad: 0.2,
        cutoff_rad: 0.8,
        texture: Some(slide),
    };
    let turned = to_local(2.9, 0.2);
    let projector = BeamProfile::Projector {
        half_tangents: vec2(0.5, 0.4),
        scale: 0.7,
        axis: turned.transpose() * Vec3::Z,
    };
    for (key, position, to_local, profile, power) in [
        (
            "spot",
            vec3(-0.6, -0.9, 1.8),
            to_local(3.0, -0.1),
            spot,
            slide + 2,
        ),
        (
            "projector",
            vec3(0.3, -0.4, 2.1),
            turned,
            projector,
            slide + 1,
        ),
    ] {
        scene.delta_lights.push(DeltaLight {
            key: key.into(),
            kind: DeltaLightKind::Point { position },
            power,
            beam: Some(Beam { to_local, profile }),
        });
    }
    let power = Texture::constant("spot.intensity".into(), [3.0, 2.5, 4.0]);
    scene.textures.push(power);
    scene
}

#[test]
fn interior_in_beams() {
    transposed(&with_beams(materials(3, Some(0.2))), Method::Interior, IDLE);
}

#[test]
fn depth_3() {
    transposed(&materials(3, Some(0.2)), Method::Reparam, IDLE);
}

#[test]
fn faces_with_colours_of_their_own() {
    let shell = ball(1, vec3(0.2, 0.8, 0.6), 0.3);
    let scene = materials(3, Some(0.2)).smooth("shell", shell, [0.5; 3]);
    transposed(&scene.faces("shell"), Method::Reparam, IDLE);
}

#[test]
fn depth_4() {
    transposed(&materials(4, Some(0.2)), Method::Reparam, IDLE);
}

/// Layers, brushed metal and glass, and a blend; masks and panes are refused where things move.
fn layered(depth: u32, has_pane: bool) -> Scene {
    let block = |at: Vec3| placed(cuboid(Vec3::splat(0.25)), vec3(10.0, 20.0, 30.0), at);
    let scene = scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.3),
        40.0,
        [12, 10],
        GAUSSIAN,
    );
    let scene = scene
        .depth(depth)
        .solid("floor", floor(1.5, 0.0), [0.5; 3])
        .smooth("narrow", ball(2, vec3(0.5, -0.1, 0.4), 0.35), [0.5; 3])
        .solid("wide", block(vec3(-0.6, 0.4, 0.4)), [0.5; 3])
        .solid("glass", block(vec3(-0.2, -0.8, 0.5)), [0.5; 3])
        .smooth("plastic", ball(1, vec3(-0.9, -0.5, 0.3), 0.3), [0.5; 3])
        .light("lamp", ceiling(vec3(0.2, 0.1, 2.5), 0.5), [5.0, 6.0, 4.0])
        .layers("floor", 0.25)
        .brushed("narrow", [0.1, 0.3], Beckmann)
        .layers("wide", 0.1)
        .clear_layers("plastic", 0.2)
        .blended("floor", 0.4)
        .sunny();
    if has_pane {
        scene.pane("glass")
    } else {
        scene.brushed_glass("glass", [0.2, 0.12])
    }
}

#[test]
fn reliefs_depth_3() {
    let scene = layered(3, false)
        .relief("narrow", None)
        .relief("wide", Some(0.05));
    transposed(&scene, Method::Reparam, IDLE_LAYERS);
}

#[test]
fn layered_depth_3() {
    transposed(&layered(3, false), Method::Reparam, IDLE_LAYERS);
}

#[test]
fn interior_masks_depth_4() {
    let scene = with_a_bulb(layered(4, true).masked("plastic", 0.6));
    transposed(&scene, Method::Interior, IDLE_LAYERS);
}

#[test]
fn interior_depth_4() {
    transposed(&with_a_bulb(materials(4, None)), Method::Interior, IDLE);
}
