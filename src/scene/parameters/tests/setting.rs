//! Values in place of the scene's.

use super::*;
use crate::scene::data::DeltaLightKind;

#[test]
// Long: every kind of parameter.
fn setting_is_what_moving_there_gives() {
    let base = scene();
    let set = |key: &str, values: &[f32]| {
        let mut scene = base.clone();
        apply(&mut scene, &find(&base, key).unwrap(), values).map(|()| scene)
    };
    let go = |key: &str, values: &[f32], step: f64| {
        displace(&base, &[(find(&base, key).unwrap(), values)], step).unwrap()
    };
    let turned = set("computed.rotation", &[0.2, 0.4, 0.6]).unwrap();
    let stepped = go("computed.rotation", &[0.1, 0.2, 0.3], 2.0);
    assert_eq!(turned.meshes[1].positions, stepped.meshes[1].positions);
    // Computed normals turn with the mesh.
    let turn = glam::Quat::from_scaled_axis(glam::Vec3::new(0.2, 0.4, 0.6));
    let (before, after) = (
        base.meshes[1].normals.vertex().unwrap(),
        turned.meshes[1].normals.vertex().unwrap(),
    );
    for (b, a) in before.iter().zip(after) {
        assert!((turn * *b - *a).length() < 1e-6);
    }
    assert_eq!(
        set("cam.x_fov", &[60.0]).unwrap().sensors[0].x_fov_rad,
        60f32.to_radians()
    );
    assert_eq!(
        set("sun.irradiance.value", &[1.0, 2.0, 3.0])
            .unwrap()
            .textures[base.delta_lights[1].power]
            .texels,
        [[1.0, 2.0, 3.0]]
    );
    let light = |s: Scene| s.delta_lights[0].kind;
    let there = DeltaLightKind::Point {
        position: glam::Vec3::new(2.0, 2.0, 5.0),
    };
    assert_eq!(
        light(set("bulb.position", &[2.0, 2.0, 5.0]).unwrap()),
        there
    );
    assert_eq!(
        light(set("bulb.translation", &[1.0, 0.0, 2.0]).unwrap()),
        there
    );
    assert_eq!(light(go("bulb.position", &[1.0, 0.0, 2.0], 1.0)), there);
    let numbers = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let placed = set("computed.bsdf.reflectance.to_uv", &numbers).unwrap();
    let t = base
        .textures
        .iter()
        .position(|t| t.key == "computed.bsdf.reflectance");
    let to_uv = placed.textures[t.unwrap()].layout.to_uv().unwrap();
    // (u, v) ↦ (u + 2v + 3, 4u + 5v + 6)
    assert_eq!(
        to_uv.transform_point2(glam::Vec2::X),
        glam::Vec2::new(4.0, 10.0)
    );
    assert_eq!(
        to_uv.transform_point2(glam::Vec2::Y),
        glam::Vec2::new(5.0, 11.0)
    );
    let brighter = set("env.scale", &[4.0]).unwrap();
    assert_eq!(brighter.environment.unwrap().map.unwrap().scale, 4.0);
    assert!(set("env.scale", &[-1.0]).is_err());
    assert!(set("env.data", &[-1.0, 0.0, 0.0]).is_err());
    assert!(set("coarse.color0.value", &[0.0]).is_err());
    assert!(set("pane.bsdf.eta", &[0.0]).is_err());
    assert!(set("cam.x_fov", &[180.0]).is_err());
    assert!(set("given.scale", &[0.0]).is_err());
    assert!(set("paint.reflectance.value", &[1.5, 0.0, 0.0]).is_err());
    // A matrix in place of another takes the same points elsewhere.
    let rows = [
        2.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let placed = set("computed.to_world", &rows).unwrap();
    let pairs = base.meshes[1]
        .positions
        .iter()
        .zip(&placed.meshes[1].positions);
    for (before, after) in pairs {
        let expected = glam::Vec3::new(2.0 * before.x + 1.0, before.y, before.z - 1.0);
        assert!((expected - *after).length() < 1e-6);
    }
    let mut mirrored = rows;
    mirrored[0] = -2.0;
    assert!(set("computed.to_world", &mirrored).is_err());
    // An instance's shapes move as one, about the middle of all of them.
    let twin = base.instances[0].body;
    let turned = set("twin.rotation", &[0.0, 0.0, 0.5]).unwrap();
    let distance = |scene: &Scene| {
        let [a, b] = [twin.first, twin.first + 1].map(|m| scene.meshes[m].positions[0]);
        (a - b).length()
    };
    assert!((distance(&base) - distance(&turned)).abs() < 1e-5);
    assert!(base.meshes[twin.first].positions != turned.meshes[twin.first].positions);
    // One number is a grey colour.
    let grey = set("sun.irradiance.value", &[0.5]).unwrap();
    let t = base.delta_lights[1].power;
    assert_eq!(grey.textures[t].texels, [[0.5; 3]]);
}
