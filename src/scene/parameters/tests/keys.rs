//! Keys against Mitsuba's, and what belongs to them.

use super::*;

#[test]
fn only_what_is_needed_is_wanted() {
    let scene = scene();
    let want = |key: &str| wanted(&scene, &[find(&scene, key).unwrap()], 0).unwrap();
    assert!(!want("paint.reflectance.value").moves_geometry());
    let translation = want("given.translation");
    assert!(translation.positions[0].is_some() && translation.positions[1].is_none());
    assert!(translation.given_normals[0].is_none());
    assert!(want("given.rotation").given_normals[0].is_some());
}

#[test]
fn keys_are_mitsubas() {
    let scene = scene();
    let keys: Vec<String> = list(&scene).into_iter().map(|p| p.key).collect();
    for key in [
        "given.vertex_positions",
        "given.faces",
        "given.vertex_normals",
        "PLYMesh.vertex_positions",
        "light.emitter.radiance.value",
        "light.bsdf.reflectance.value",
        "paint.brdf_0.reflectance.value",
        "computed.bsdf.reflectance.data",
        "computed.bsdf.reflectance.to_uv",
        "env.data",
        "env.scale",
        "env.rotation",
        "bulb.position",
        "bulb.translation",
        "bulb.intensity.value",
        "sun.irradiance.value",
        "sun.direction",
        "board.color0.value",
        "board.color1.value",
        "board.to_uv",
        "coarse.color0.value",
        "metal.eta.value",
        "metal.k.value",
        "floor.bsdf.brdf_0.alpha",
        "floor.bsdf.brdf_0.eta",
        "floor.bsdf.brdf_0.specular_reflectance.value",
        "pane.bsdf.eta",
        "pane.bsdf.specular_transmittance.value",
        "frost.bsdf.alpha.data",
        "box.vertex_texcoords",
        "cam.x_fov",
        "cam.film.size",
        "PerspectiveCamera.translation",
        "cam.to_world",
        "cam.principal_point_offset_x",
        "given.to_world",
        "twin.translation",
        "twin.to_world",
        "twin.inner.vertex_positions",
        "twin.Cube.rotation",
        "torch.position",
        "torch.intensity.value",
        "torch.cutoff_angle",
    ] {
        assert!(keys.iter().any(|k| k == key), "{key} is not in {keys:#?}");
    }
    let mut unique = keys.clone();
    unique.sort();
    unique.dedup();
    assert_eq!(unique.len(), keys.len());
    let alias = find(&scene, "given.bsdf.brdf_0.reflectance.value").unwrap();
    assert_eq!(alias.key, "paint.brdf_0.reflectance.value");
    for (alias, key) in [
        ("given.normals", "given.vertex_normals"),
        ("given.positions", "given.vertex_positions"),
    ] {
        assert_eq!(find(&scene, alias).unwrap().key, key);
    }
    let shape = find(&scene, "given.positions").unwrap().shape;
    assert_eq!(shape, [4, 3]);
}

#[test]
fn wrong_keys_and_values_are_refused() {
    let scene = scene();
    let message = |key: &str, values: Vec<f32>| {
        tangent(&scene, &[(key, values)], 0)
            .unwrap_err()
            .to_string()
    };
    assert!(message("given.vertex_position", vec![0.0; 3]).contains("\"given.vertex_positions\""));
    assert!(message("given.faces", vec![0.0; 3]).contains("cannot be differentiated"));
    assert!(message("given.vertex_positions", vec![0.0; 4]).contains("4×3"));
    assert!(message("cam.x_fov", vec![0.0; 3]).contains("takes 1"));
    assert!(message("cam.x_fov", vec![f32::NAN]).contains("finite"));
    assert!(message("board.to_uv", vec![0.0; 6]).contains("edges"));
    assert!(message("frost.bsdf.alpha.to_uv", vec![0.0; 6]).contains("bilinear"));
    assert!(message("sun.direction", vec![0.0; 3]).contains("cannot be differentiated"));
    assert!(message("computed.vertex_normals", vec![0.0; 3]).contains("follow"));
    assert!(message("torch.beam_width", vec![0.0]).contains("not implemented"));
    assert!(message("env.to_uv", vec![0.0; 6]).contains("no parameter"));
    assert!(message("env.data", vec![0.0; 4]).contains("3×4×3"));
    assert!(message("PerspectiveCamera.x_fov", vec![1.0]).contains("--sensor 1"));
}

#[test]
fn a_texture_is_one_parameter_by_many_names() {
    let scene = scene();
    let key = |name: &str| find(&scene, name).unwrap().key;
    for name in [
        "board.color1.value",
        "metal.specular_reflectance.color1.value",
        "box.bsdf.specular_reflectance.color1.value",
        "floor.bsdf.brdf_0.diffuse_reflectance.color1.value",
        "floor.bsdf.diffuse_reflectance.color1.value",
    ] {
        assert_eq!(key(name), "board.color1.value");
    }
    // A number that Mitsuba holds without a texture has no ".value"; both spellings are taken.
    assert_eq!(key("pane.bsdf.eta.value"), "pane.bsdf.eta");
    assert_eq!(key("floor.bsdf.alpha.value"), "floor.bsdf.brdf_0.alpha");
    // Mitsuba exchanges the colours of a checkerboard that is a number.
    let texel = |name: &str| match find(&scene, name).unwrap().target {
        Some(Target::Texel { texture, texel }) => scene.textures[texture].texels[texel][0],
        other => panic!("{name} is {other:?}"),
    };
    assert_eq!(texel("coarse.color0.value"), 0.3);
    assert_eq!(texel("board.color0.value"), 0.1);
    let coarse = scene.textures.iter().find(|t| t.key == "coarse").unwrap();
    assert_eq!(coarse.texels[0][0], 0.6);
}

#[test]
fn what_moves_visibility_says_so() {
    let scene = scene();
    for (key, moves) in [
        ("bulb.position", true),
        ("box.vertex_positions", true),
        ("pane.bsdf.eta", true),
        ("frost.bsdf.eta", false),
        ("metal.eta.value", false),
        ("env.rotation", false),
        ("board.color0.value", false),
        ("computed.bsdf.reflectance.to_uv", false),
    ] {
        assert_eq!(find(&scene, key).unwrap().moves_visibility, moves, "{key}");
    }
}
