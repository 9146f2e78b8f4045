//! Tangents against finite differences, gradients against tangents, keys against Mitsuba's.

use super::*;
use crate::scene::SceneDifferential;
use crate::scene::data::{DeltaLightKind, EnvironmentMap, Layout, Normals, Scene, Wrap};
use crate::scene::load_from;
use crate::scene::source::Memory;

const PLY_WITH_NORMALS: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0.1 0 0.6 0.8\n1 2 0 0 0 1\n\
    0 1 -0.2 0.6 0 0.8\n3 0 1 2\n3 0 2 3\n";

const PLY_PLAIN: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 4\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n\
    0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

const SCENE: &str = r#"<scene version="3.0.0">
  <bsdf type="twosided" id="paint"><bsdf type="diffuse"><rgb name="reflectance" value="0.2 0.3 0.4"/></bsdf></bsdf>
  <sensor type="perspective" id="cam"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="1 -4 2" target="0 0 0" up="0 0 1"/></transform></sensor>
  <sensor type="perspective"><float name="fov" value="50"/></sensor>
  <shape type="ply" id="given"><string name="filename" value="given.ply"/><ref id="paint"/>
    <transform name="to_world"><scale x="-1" y="2" z="1.5"/><translate x="0.3"/></transform></shape>
  <shape type="ply" id="computed"><string name="filename" value="plain.ply"/></shape>
  <shape type="ply"><string name="filename" value="plain.ply"/><boolean name="face_normals" value="true"/>
    <ref id="paint"/></shape>
  <shape type="rectangle" id="light"><emitter type="area"><rgb name="radiance" value="3 2 1"/></emitter></shape>
  <emitter type="constant" id="env"><rgb name="radiance" value="0.5 0.6 0.7"/></emitter>
  <emitter type="point" id="bulb"><point name="position" x="1" y="2" z="3"/></emitter>
  <emitter type="directional" id="sun"><rgb name="irradiance" value="3 2 1"/></emitter>
  <texture type="checkerboard" id="board"><rgb name="color0" value="0.1 0.2 0.3"/></texture>
  <texture type="checkerboard" id="coarse"><float name="color0" value="0.3"/><float name="color1" value="0.6"/></texture>
  <shape type="cube" id="box"><bsdf type="roughconductor" id="metal"><string name="material" value="Au"/>
    <ref id="coarse" name="alpha"/><ref id="board" name="specular_reflectance"/></bsdf></shape>
  <shape type="rectangle" id="floor"><bsdf type="twosided"><bsdf type="roughplastic">
    <ref id="board" name="diffuse_reflectance"/></bsdf></bsdf></shape>
  <shape type="cube" id="pane"><bsdf type="dielectric"/></shape>
  <shape type="cube" id="frost"><bsdf type="roughdielectric"/></shape>
</scene>"#;

/// The loaded scene, with pictures put into it: a bitmap in place of the reflectance of `computed`, a grey one with a
/// `nearest` filter as the roughness of `frost`, and an environment map.
fn scene() -> Scene {
    let mut scene = loaded();
    let mut random = Random(3);
    let mut picture = |scene: &mut Scene, key: &str, bilinear: bool| {
        let slot = scene.textures.iter().position(|t| t.key == key);
        let texture = &mut scene.textures[slot.expect("the slot is there")];
        let grey = texture.channels == 1;
        texture.texels = (0..12)
            .map(|_| {
                let [r, g, b] = [0; 3].map(|_| 0.5 + 0.4 * random.next());
                if grey { [r; 3] } else { [r, g, b] }
            })
            .collect();
        texture.layout = Layout::Bitmap {
            width: 4,
            height: 3,
            wrap: Wrap::Repeat,
            bilinear,
            to_uv: glam::Affine2::from_scale_angle_translation(
                glam::Vec2::new(2.0, 3.0),
                0.3,
                glam::Vec2::new(0.1, 0.2),
            ),
        };
    };
    picture(&mut scene, "computed.bsdf.reflectance", true);
    picture(&mut scene, "frost.bsdf.alpha", false);
    picture(&mut scene, "env.radiance", true);
    for texture in scene
        .textures
        .iter_mut()
        .filter(|t| t.key == "env.radiance")
    {
        texture.key = "env".to_string();
    }
    if let Some(environment) = &mut scene.environment {
        environment.map = Some(EnvironmentMap {
            to_world: glam::Mat3::from_rotation_x(0.7),
            scale: 1.5,
        });
    }
    scene
}

fn loaded() -> Scene {
    let files = Memory::new()
        .with("s.xml", SCENE)
        .with("given.ply", PLY_WITH_NORMALS)
        .with("plain.ply", PLY_PLAIN);
    load_from(&files, "s.xml", &[]).expect("the test scene loads")
}

/// Numbers in −1…1 that are the same on every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    fn values(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| self.next()).collect()
    }
}

fn differentiable(scene: &Scene) -> Vec<Parameter> {
    list(scene)
        .into_iter()
        .filter(|p| p.differentiable)
        .collect()
}

/// The sensor that a parameter belongs to, or any.
fn sensor_of(parameter: &Parameter) -> usize {
    parameter.target.and_then(Target::sensor).unwrap_or(0)
}

/// All numbers of a differential in a fixed order, zeros for what is not there.
fn flat(d: &mut SceneDifferential, scene: &Scene) -> Vec<f64> {
    let mut all = d.clone();
    for m in 0..scene.meshes.len() {
        all.want_mesh(scene, m);
    }
    let mut out = Vec::new();
    for vectors in all.positions.iter().chain(&all.given_normals).flatten() {
        out.extend(vectors.iter().flat_map(|v| v.to_array()).map(f64::from));
    }
    for t in 0..scene.textures.len() {
        all.want_texels(scene, t);
    }
    out.extend(
        all.texels
            .iter()
            .flatten()
            .flatten()
            .flatten()
            .map(|&v| f64::from(v)),
    );
    for to_uv in &all.to_uv {
        out.extend(to_uv.unwrap_or_default().map(f64::from));
    }
    let environment = all.environment.unwrap_or_default();
    out.push(f64::from(environment.scale));
    for light in &all.delta_lights {
        out.extend(light.unwrap_or_default().to_array().map(f64::from));
    }
    let camera = all.camera.unwrap_or_default();
    out.extend(camera.translation.to_array().map(f64::from));
    out.extend(camera.rotation.to_array().map(f64::from));
    out.push(f64::from(camera.x_fov_deg));
    out.extend(environment.rotation.to_array().map(f64::from));
    out
}

/// (plus − minus) / (2·step), in the order of [`flat`].
fn difference(plus: &Scene, minus: &Scene, base: &Scene, sensor: usize, step: f64) -> Vec<f64> {
    let numbers = |scene: &Scene| {
        let mut out: Vec<f64> = Vec::new();
        for mesh in &scene.meshes {
            out.extend(
                mesh.positions
                    .iter()
                    .flat_map(|v| v.to_array())
                    .map(f64::from),
            );
        }
        for mesh in &scene.meshes {
            if let Normals::Given(normals) = &mesh.normals {
                out.extend(normals.iter().flat_map(|v| v.to_array()).map(f64::from));
            }
        }
        out.extend(
            scene
                .textures
                .iter()
                .flat_map(|t| &t.texels)
                .flatten()
                .map(|&v| f64::from(v)),
        );
        for texture in &scene.textures {
            let to_uv = texture.layout.to_uv().unwrap_or_default();
            out.extend(surfaces::rows(to_uv).map(f64::from));
        }
        let map = scene.environment.as_ref().and_then(|e| e.map);
        out.push(map.map_or(0.0, |m| f64::from(m.scale)));
        for light in &scene.delta_lights {
            out.extend(match light.kind {
                DeltaLightKind::Point { position } => position.to_array().map(f64::from),
                DeltaLightKind::Directional { .. } => [0.0; 3],
            });
        }
        out.extend(
            scene.sensors[sensor]
                .to_world
                .translation
                .to_array()
                .map(f64::from),
        );
        out
    };
    let (a, b) = (numbers(plus), numbers(minus));
    let mut out: Vec<f64> = a
        .iter()
        .zip(&b)
        .map(|(a, b)| (a - b) / (2.0 * step))
        .collect();
    // dM = [ω]× M, so ω stands in the antisymmetric part of dM·Mᵀ.
    let spin = |matrix: &dyn Fn(&Scene) -> glam::DMat3| {
        let spin = (matrix(plus) - matrix(minus)) * matrix(base).transpose() * (0.25 / step);
        [
            spin.y_axis.z - spin.z_axis.y,
            spin.z_axis.x - spin.x_axis.z,
            spin.x_axis.y - spin.y_axis.x,
        ]
    };
    out.extend(spin(&|s| {
        glam::Mat3::from(s.sensors[sensor].to_world.matrix3).as_dmat3()
    }));
    let fov = |s: &Scene| f64::from(s.sensors[sensor].x_fov_rad).to_degrees();
    out.push((fov(plus) - fov(minus)) / (2.0 * step));
    out.extend(spin(&|s| {
        let map = s.environment.as_ref().and_then(|e| e.map);
        map.map_or(glam::DMat3::IDENTITY, |m| m.to_world.as_dmat3())
    }));
    out
}

#[test]
fn tangents_are_what_finite_differences_tend_to() {
    let scene = scene();
    let mut random = Random(7);
    let step = 1e-2;
    for parameter in differentiable(&scene) {
        let values = random.values(parameter.len());
        let sensor = sensor_of(&parameter);
        let mut tangent = tangent(&scene, &[(&parameter.key, &values)], sensor).unwrap();
        let moved = |step| displace(&scene, &[(parameter.clone(), &values)], step).unwrap();
        let differences = difference(&moved(step), &moved(-step), &scene, sensor, step);
        let tangents = flat(&mut tangent, &scene);
        assert_eq!(tangents.len(), differences.len());
        assert!(
            tangents.iter().any(|v| v.abs() > 0.01),
            "{} moves nothing",
            parameter.key
        );
        for (i, (t, d)) in tangents.iter().zip(&differences).enumerate() {
            assert!(
                (t - d).abs() < 5e-4,
                "{} number {i}: {t} against {d}",
                parameter.key
            );
        }
    }
}

#[test]
fn several_directions_add_up() {
    let scene = scene();
    let directions = [
        ("given.translation", vec![0.1, 0.2, 0.3]),
        ("given.rotation", vec![0.3, -0.2, 0.5]),
        ("given.scale", vec![0.7]),
        ("given.positions", vec![0.1, -0.1, 0.4]),
        ("paint.reflectance.value", vec![0.1, 0.2, 0.3]),
        ("given.bsdf.reflectance.value", vec![0.1, 0.2, 0.3]),
        ("cam.rotation", vec![0.2, 0.1, 0.4]),
        ("board.color0.value", vec![0.3, 0.2, 0.1]),
        (
            "box.bsdf.specular_reflectance.color0.value",
            vec![0.3, 0.2, 0.1],
        ),
        ("env.rotation", vec![0.2, -0.1, 0.3]),
        ("env.rotation", vec![0.1, 0.4, 0.2]),
        ("bulb.position", vec![0.2, -0.1, 0.3]),
        ("bulb.translation", vec![0.2, -0.1, 0.3]),
        ("computed.bsdf.reflectance.to_uv", vec![0.2, -0.1, 0.3]),
    ];
    let mut all = tangent(&scene, &directions, 0).unwrap();
    let mut sum = vec![0.0; flat(&mut all, &scene).len()];
    for one in &directions {
        let mut d = tangent(&scene, std::slice::from_ref(one), 0).unwrap();
        for (s, v) in sum.iter_mut().zip(flat(&mut d, &scene)) {
            *s += v;
        }
    }
    let found = directions.map(|(key, values)| (find(&scene, key).unwrap(), values));
    let moved = |step| displace(&scene, &found, step).unwrap();
    let step = 5e-3;
    let differences = difference(&moved(step), &moved(-step), &scene, 0, step);
    for ((a, s), d) in flat(&mut all, &scene).iter().zip(&sum).zip(&differences) {
        assert!((a - s).abs() < 1e-6 && (a - d).abs() < 1e-3, "{a} {s} {d}");
    }
}

#[test]
fn gradients_are_the_transpose_of_tangents() {
    let scene = scene();
    let mut random = Random(11);
    for parameter in differentiable(&scene) {
        let sensor = sensor_of(&parameter);
        let mut cotangent = wanted(&scene, std::slice::from_ref(&parameter), sensor).unwrap();
        fill(&mut cotangent, &mut random);
        let values = random.values(parameter.len());
        let mut tangent = tangent(&scene, &[(&parameter.key, &values)], sensor).unwrap();
        let (t, c) = (flat(&mut tangent, &scene), flat(&mut cotangent, &scene));
        let forward: f64 = t.iter().zip(&c).map(|(a, b)| a * b).sum();
        let gradient = reduce(&scene, &parameter, &cotangent);
        assert_eq!(gradient.len(), parameter.len(), "{}", parameter.key);
        let pairs = values.iter().zip(&gradient);
        let reverse: f64 = pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
        assert!(
            (forward - reverse).abs() < 1e-5 * (1.0 + forward.abs()),
            "{}: {forward} against {reverse}",
            parameter.key
        );
    }
}

/// Random numbers in everything that is wanted.
fn fill(cotangent: &mut SceneDifferential, random: &mut Random) {
    for vectors in cotangent
        .positions
        .iter_mut()
        .chain(&mut cotangent.given_normals)
        .flatten()
    {
        for vector in vectors {
            *vector = glam::Vec3::from_slice(&random.values(3));
        }
    }
    for colour in cotangent.texels.iter_mut().flatten().flatten() {
        *colour = [random.next(), random.next(), random.next()];
    }
    for number in cotangent.to_uv.iter_mut().flatten().flatten() {
        *number = random.next();
    }
    if let Some(environment) = &mut cotangent.environment {
        environment.scale = random.next();
        environment.rotation = glam::Vec3::from_slice(&random.values(3));
    }
    for light in cotangent.delta_lights.iter_mut().flatten() {
        *light = glam::Vec3::from_slice(&random.values(3));
    }
    if let Some(camera) = &mut cotangent.camera {
        camera.translation = glam::Vec3::from_slice(&random.values(3));
        camera.rotation = glam::Vec3::from_slice(&random.values(3));
        camera.x_fov_deg = random.next();
    }
}

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
    ] {
        assert!(keys.iter().any(|k| k == key), "{key} is not in {keys:#?}");
    }
    let mut unique = keys.clone();
    unique.sort();
    unique.dedup();
    assert_eq!(unique.len(), keys.len());
    let alias = find(&scene, "given.bsdf.brdf_0.reflectance.value").unwrap();
    assert_eq!(alias.key, "paint.brdf_0.reflectance.value");
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
    assert!(message("env.to_uv", vec![0.0; 6]).contains("no parameter"));
    assert!(message("env.data", vec![0.0; 4]).contains("3×4×3"));
    assert!(message("PerspectiveCamera.x_fov", vec![1.0]).contains("--sensor 1"));
}

#[test]
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
