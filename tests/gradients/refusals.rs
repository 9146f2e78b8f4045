//! What would be silently wrong is refused, in a sentence that names what it is about; what is no
//! trouble is not.

use common::materials::Paint;
use common::scenes::*;
use common::{Quiet, direction, settings};
use glam::vec3;
use warpath::methods::{Method, forward};
use warpath::scene::{DeltaLight, DeltaLightKind, Scene, Texture};

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
fn sharp_shadows() {
    let point = DeltaLightKind::Point {
        position: vec3(0.3, 0.2, 2.0),
    };
    let scene = lamp(point);
    refused(&scene, "block.translation", &MOVED, "bulb");
    refused(&scene, "bulb.translation", &MOVED, "bulb");
    refused(&scene, "bulb.position", &MOVED, "bulb");
    taken(&scene, Method::Interior, "bulb.translation", &MOVED);
    taken(&scene, Method::Reparam, "bulb.intensity.value", &MOVED);
    let direction = vec3(0.0, 0.0, -1.0);
    refused(
        &lamp(DeltaLightKind::Directional { direction }),
        "block.translation",
        &MOVED,
        "bulb",
    );
}
