//! What would be silently wrong is refused, in a sentence that names what it is about; what is no
//! trouble is not.

use common::materials::Paint;
use common::scenes::*;
use common::{Quiet, direction, settings};
use glam::{Affine2, Mat3, Vec3, vec2, vec3};
use std::f32::consts::PI;
use warpath::methods::{Method, forward};
use warpath::scene::{Beam, BeamProfile, DeltaLight, DeltaLightKind, Layout, Lens, Scene, Texture};

fn close_up() -> Scene {
    common::comparison::close_up().constant_environment([0.7, 0.8, 1.0])
}

/// The refusal, or nothing.
fn refusal(scene: &Scene, method: Method, key: &str, by: &[f32]) -> Option<String> {
    let along = direction(scene, &[(key, by)]);
    let settings = settings(scene, method, 4, 1);
    forward(scene, &settings, &along, &Quiet)
        .err()
        .map(|e| e.to_string())
}

fn refused(scene: &Scene, key: &str, by: &[f32], about: &str) {
    let said =
        refusal(scene, Method::Reparam, key, by).unwrap_or_else(|| panic!("{key} is not refused"));
    assert!(said.contains(about), "{key}: {said}");
}

/// By a method, for what moves.
fn refused_by(scene: &Scene, method: Method, key: &str, about: &str) {
    let said = refusal(scene, method, key, &MOVED);
    let said = said.unwrap_or_else(|| panic!("{key} is not refused"));
    assert!(said.contains(about), "{key}: {said}");
}

fn taken(scene: &Scene, method: Method, key: &str, by: &[f32]) {
    let said = refusal(scene, method, key, by);
    assert!(said.is_none(), "{key}: {said:?}");
}

const MOVED: [f32; 3] = [1.0, 0.0, 0.0];

fn lamp(kind: DeltaLightKind) -> Scene {
    let mut scene = close_up();
    scene
        .textures
        .push(Texture::constant("bulb.intensity".into(), [1.0; 3]));
    scene.delta_lights.push(DeltaLight {
        key: "bulb".into(),
        kind,
        power: scene.textures.len() - 1,
        beam: None,
    });
    scene
}

#[test]
fn sharp_reflections() {
    let scene = close_up().plastic("floor", None);
    taken(&scene, Method::Reparam, "block.translation", &MOVED);
    taken(&scene, Method::Reparam, "cam.translation", &MOVED);
    taken(&scene, Method::Reparam, "floor.bsdf.eta", &[1.0]);
    taken(
        &scene,
        Method::Reparam,
        "floor.bsdf.diffuse_reflectance.value",
        &MOVED,
    );
}

#[test]
fn sharp_shadows_are_not_refused() {
    let point = DeltaLightKind::Point {
        position: vec3(0.3, 0.2, 2.0),
    };
    let scene = lamp(point);
    for method in [Method::Reparam, Method::Interior] {
        taken(&scene, method, "block.translation", &MOVED);
        taken(&scene, method, "bulb.translation", &MOVED);
        taken(&scene, method, "bulb.position", &MOVED);
        taken(&scene, method, "bulb.intensity.value", &MOVED);
    }
    let mirrored = scene.plastic("floor", None);
    taken(&mirrored, Method::Reparam, "bulb.translation", &MOVED);
    let direction = vec3(0.0, 0.0, -1.0);
    let scene = lamp(DeltaLightKind::Directional { direction });
    taken(&scene, Method::Reparam, "block.translation", &MOVED);
}

/// Of a mixture chains know only that a mask lets light through.
#[test]
fn what_is_smooth_inside_of_mixtures() {
    let masked = close_up().masked("block", 0.5);
    taken(&masked, Method::Reparam, "block.translation", &MOVED);
    refused_by(&masked, Method::Edges, "block.translation", "a mask");
    let pane = close_up().pane("block");
    taken(&pane, Method::Reparam, "block.translation", &MOVED);
    let smooth = close_up().mirror("block").masked("block", 0.5);
    taken(&smooth, Method::Reparam, "block.translation", &MOVED);
    let twice = masked.masked("block", 0.5);
    taken(&twice, Method::Reparam, "block.translation", &MOVED);
    let turned = close_up().mirror("block").relief("block", None);
    taken(&turned, Method::Reparam, "block.translation", &MOVED);
    refused_by(
        &turned,
        Method::Edges,
        "block.translation",
        "perfectly smooth",
    );
}

#[test]
fn edges_of_beams() {
    let position = vec3(0.3, 0.2, 2.0);
    let beam = |profile| {
        let mut scene = lamp(DeltaLightKind::Point { position });
        let to_local = Mat3::from_rotation_x(PI);
        scene.delta_lights[0].beam = Some(Beam { to_local, profile });
        scene
    };
    let projector = beam(BeamProfile::Projector {
        half_tangents: vec2(0.5, 0.5),
        scale: 1.0,
        axis: -Vec3::Z,
    });
    taken(&projector, Method::Reparam, "block.translation", &MOVED);
    taken(&projector, Method::Reparam, "bulb.translation", &MOVED);
    refused_by(
        &projector,
        Method::Edges,
        "block.translation",
        "picture's border",
    );
    let mut coarse = projector.clone();
    let power = coarse.delta_lights[0].power;
    coarse.textures[power].layout = Layout::Checkerboard {
        to_uv: Affine2::IDENTITY,
    };
    refused(&coarse, "block.translation", &MOVED, "picture jumps");
    taken(&projector, Method::Interior, "block.translation", &MOVED);
    taken(&projector, Method::Reparam, "bulb.intensity.value", &MOVED);
    let sudden = beam(BeamProfile::Spot {
        beam_width_rad: 0.4,
        cutoff_rad: 0.4,
        texture: None,
    });
    taken(&sudden, Method::Reparam, "block.translation", &MOVED);
    refused_by(&sudden, Method::Edges, "block.translation", "beam_width");
}

#[test]
fn lenses() {
    let seen_by = |lens| {
        let mut scene = close_up();
        scene.sensors[0].lens = lens;
        scene
    };
    let thin = seen_by(Lens::Thin {
        aperture_radius: 0.1,
        focus_distance: 3.0,
    });
    taken(&thin, Method::Reparam, "block.translation", &MOVED);
    taken(&thin, Method::Edges, "block.translation", &MOVED);
    refused_by(&thin, Method::Loubet, "block.translation", "aperture");
    refused_by(&thin, Method::WarpedArea, "cam.translation", "aperture");
    let [parallel, uneven] = [1.0, 0.8].map(|y| {
        seen_by(Lens::Parallel {
            half_sides: vec2(1.0, y),
        })
    });
    taken(&parallel, Method::Reparam, "block.translation", &MOVED);
    refused_by(&parallel, Method::Edges, "block.translation", "parallel");
    refused_by(&parallel, Method::Loubet, "cam.translation", "parallel");
    taken(&uneven, Method::Reparam, "block.translation", &MOVED);
    taken(&uneven, Method::Reparam, "cam.translation", &MOVED);
    let paint = "floor.bsdf.brdf_0.reflectance.value";
    taken(&thin, Method::Reparam, paint, &MOVED);
    taken(&uneven, Method::Reparam, paint, &MOVED);
}
