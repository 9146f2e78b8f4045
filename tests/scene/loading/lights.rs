//! Lights, environment maps, and colours of what emits.

use super::{SENSOR, floats, scene, with_files};
use glam::Vec3;
use warpath::scene::DeltaLightKind;
use warpath::scene::source::Memory;

#[test]
fn lights_without_extent_have_places_and_directions() {
    let turned = "<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/><translate x=\"3\"/></transform>";
    let scene = scene(&format!(
        "<emitter type=\"point\" id=\"bulb\"><point name=\"position\" value=\"1 2 3\"/><rgb name=\"intensity\" value=\"5\"/></emitter>\
         <emitter type=\"point\">{turned}</emitter>\
         <emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/></emitter>\
         <emitter type=\"directional\">{turned}<rgb name=\"irradiance\" value=\"1 2 3\"/></emitter>"
    ));
    let kinds: Vec<DeltaLightKind> = scene.delta_lights.iter().map(|l| l.kind).collect();
    let point = |position| DeltaLightKind::Point { position };
    assert_eq!(kinds[0], point(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(kinds[1], point(Vec3::new(3.0, 0.0, 0.0)));
    let along = |i: usize| match kinds[i] {
        DeltaLightKind::Directional { direction } => direction,
        other => panic!("{other:?}"),
    };
    assert_eq!(along(2), Vec3::NEG_Y);
    assert!((along(3) - Vec3::X).length() < 1e-6);
    assert_eq!(scene.constant(scene.delta_lights[0].power), [5.0; 3]);
    assert_eq!(scene.constant(scene.delta_lights[3].power), [1.0, 2.0, 3.0]);
    let keys: Vec<&str> = scene.delta_lights.iter().map(|l| l.key.as_str()).collect();
    assert_eq!(
        keys,
        [
            "bulb",
            "PointLight",
            "DirectionalEmitter",
            "DirectionalEmitter_1"
        ]
    );
    assert!(scene.warnings.len() == 1, "{:?}", scene.warnings);
}

#[test]
fn environment_maps_turn_and_scale() {
    let files = Memory::new().with("s/sky.pfm", floats(4, 3, |x, y| [x as f32, y as f32, 7.0]));
    let sky = "<emitter type=\"envmap\" id=\"sky\"><string name=\"filename\" value=\"sky.pfm\"/><float name=\"scale\" value=\"2\"/>\
        <transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/><translate x=\"9\"/></transform></emitter>";
    let scene = with_files(&format!("{sky}{SENSOR}"), files.clone(), &[]);
    let environment = scene.environment.as_ref().unwrap();
    let map = environment.map.unwrap();
    assert_eq!(map.scale, 2.0);
    assert!((map.to_world * Vec3::Y - Vec3::Z).length() < 1e-6);
    let texture = &scene.textures[environment.radiance];
    assert_eq!(
        (texture.key.as_str(), texture.texels[5]),
        ("sky", [1.0, 1.0, 7.0])
    );
    let keys = warpath::scene::parameters::list(&scene);
    let keys: Vec<&str> = keys.iter().map(|p| p.key.as_str()).take(3).collect();
    assert_eq!(keys, ["sky.data", "sky.scale", "sky.rotation"]);
    let hash = |sky: &str| with_files(&format!("{sky}{SENSOR}"), files.clone(), &[]).hash;
    let other = Memory::new().with("s/sky.pfm", floats(4, 3, |_, _| [0.0; 3]));
    assert_ne!(
        hash(sky),
        with_files(&format!("{sky}{SENSOR}"), other, &[]).hash
    );
}

/// Mitsuba's RGB mode takes one value of an emitter's `spectrum` for equal energy at all
/// wavelengths, which is reddish in sRGB; other slots take it for grey (checked with `mi.traverse`
/// of Mitsuba 3.9.1).
#[test]
fn spectra_of_emitters_are_no_greys() {
    let value = |inside: &str, key: &str| {
        let scene = scene(inside);
        let texture = scene.textures.iter().find(|t| t.key.ends_with(key));
        texture.expect("a texture").texels[0]
    };
    let spectrum = |name: &str| format!("<spectrum name=\"{name}\" value=\"3\"/>");
    let reddish = [3.614_381_8, 2.844_873, 2.726_748];
    for (emitter, key) in [
        ("<emitter type=\"constant\">RADIANCE</emitter>", "radiance"),
        (
            "<shape type=\"rectangle\"><emitter type=\"area\">RADIANCE</emitter></shape>",
            "radiance",
        ),
        ("<emitter type=\"point\">INTENSITY</emitter>", "intensity"),
        (
            "<emitter type=\"directional\">IRRADIANCE</emitter>",
            "irradiance",
        ),
    ] {
        let emitter = emitter.replace(&key.to_uppercase(), &spectrum(key));
        let got = value(&emitter, key);
        let apart = (Vec3::from(got) - Vec3::from(reddish)).abs().max_element();
        assert!(apart < 1e-5, "{emitter}: {got:?}");
    }
    let body = "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.5\"/></bsdf></shape>";
    assert_eq!(value(body, "reflectance"), [0.5; 3]);
    let checks = "<shape type=\"rectangle\"><emitter type=\"area\"><texture name=\"radiance\" type=\"checkerboard\">\
        <spectrum name=\"color0\" value=\"3\"/></texture></emitter></shape>";
    assert_eq!(value(checks, "radiance"), [3.0; 3]);
}
