//! Tangents against finite differences, gradients against tangents.

use super::*;
use crate::scene::SceneDifferential;
use crate::scene::data::{DeltaLightKind, Normals};

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
    for axis in camera.axes {
        out.extend(axis.to_array().map(f64::from));
    }
    out.extend(camera.principal_point_offset.to_array().map(f64::from));
    out.extend(environment.rotation.to_array().map(f64::from));
    out
}

/// Counts what of a change of a camera's axes is a rotation as one.
fn split_axes(d: &mut SceneDifferential, scene: &Scene, sensor: usize) {
    let Some(camera) = &mut d.camera else {
        return;
    };
    let m = scene.sensors[sensor].to_world.matrix3;
    let axes = [m.x_axis, m.y_axis, m.z_axis].map(glam::Vec3::from);
    let halves = (0..3).map(|i| axes[i].cross(camera.axes[i]) * 0.5);
    let turn: glam::Vec3 = halves.sum();
    camera.rotation += turn;
    for (change, axis) in camera.axes.iter_mut().zip(axes) {
        *change -= turn.cross(axis);
    }
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
            out.extend(to_uv::rows(to_uv).map(f64::from));
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
    let turn = glam::DVec3::from_slice(&out[out.len() - 4..out.len() - 1]);
    out.extend(rest_of_camera(plus, minus, base, sensor, step, turn));
    out.extend(spin(&|s| {
        let map = s.environment.as_ref().and_then(|e| e.map);
        map.map_or(glam::DMat3::IDENTITY, |m| m.to_world.as_dmat3())
    }));
    out
}

/// The differences of a camera's axes that are no rotation, and of its principal point.
fn rest_of_camera(
    plus: &Scene,
    minus: &Scene,
    base: &Scene,
    sensor: usize,
    step: f64,
    turn: glam::DVec3,
) -> Vec<f64> {
    let matrix = |s: &Scene| glam::Mat3::from(s.sensors[sensor].to_world.matrix3).as_dmat3();
    let moved = (matrix(plus) - matrix(minus)) * (0.5 / step);
    let rest = |i: usize| moved.col(i) - turn.cross(matrix(base).col(i));
    let mut out: Vec<f64> = (0..3).flat_map(|i| rest(i).to_array()).collect();
    let offset = |s: &Scene| s.sensors[sensor].principal_point_offset.as_dvec2();
    out.extend(((offset(plus) - offset(minus)) * (0.5 / step)).to_array());
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
        split_axes(&mut tangent, &scene, sensor);
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
        let backward: f64 = pairs.map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
        assert!(
            (forward - backward).abs() < 1e-5 * (1.0 + forward.abs()),
            "{}: {forward} against {backward}",
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
        camera.axes = [0; 3].map(|_| glam::Vec3::from_slice(&random.values(3)));
        camera.principal_point_offset = glam::Vec2::from_slice(&random.values(2));
    }
}
