//! Backward: cotangents of everything in the scene become gradients of parameters.

use super::motion::pivot;
use super::parameter::Parameter;
use super::target::Target;
use super::to_world::{MatrixBar, matrix_rows};
use crate::scene::data::{Body, Normals, Scene};
use crate::scene::differential::SceneDifferential;
use crate::scene::error::SceneError;
use glam::{DAffine3, DMat3, DVec3, Vec3};

/// Zeros for exactly what the backward sweep must accumulate, so that [`reduce`] can give the
/// gradients of these parameters, seen from sensor `sensor`.
pub fn wanted(
    scene: &Scene,
    parameters: &[Parameter],
    sensor: usize,
) -> Result<SceneDifferential, SceneError> {
    let mut out = SceneDifferential::none(scene);
    for parameter in parameters {
        let target = parameter.target()?;
        parameter.check_sensor(scene, sensor)?;
        match target {
            Target::VertexPositions(m) => want_positions(&mut out, scene, m),
            Target::ShapeTranslation(body) | Target::ShapeScale(body) => {
                for m in body.meshes() {
                    want_positions(&mut out, scene, m);
                }
            }
            Target::VertexNormals(m) => out.want_mesh(scene, m),
            // These turn the normals that are data of their own.
            Target::ShapeRotation(body) | Target::ShapeToWorld(body) => {
                for m in body.meshes() {
                    out.want_mesh(scene, m);
                }
            }
            Target::SensorTranslation(_)
            | Target::SensorRotation(_)
            | Target::SensorXFov(_)
            | Target::SensorToWorld(_)
            | Target::SensorPrincipalPoint { .. } => {
                out.camera.get_or_insert_default();
            }
            Target::Texels(t) | Target::Texel { texture: t, .. } => {
                out.want_texels(scene, t);
            }
            Target::ToUv(t) => {
                out.to_uv[t].get_or_insert_default();
            }
            Target::EnvironmentScale | Target::EnvironmentRotation => {
                out.environment.get_or_insert_default();
            }
            Target::DeltaLightPosition(i) | Target::DeltaLightTranslation(i) => {
                out.delta_lights[i].get_or_insert_default();
            }
        }
    }
    Ok(out)
}

/// The gradient of one parameter, of its shape, from the cotangents of the scene. Sums over
/// vertices are in double precision and in their order. What the cotangent does not hold counts as
/// zero. Empty for a parameter that is not differentiable.
// Long: one arm for every kind of parameter.
pub fn reduce(scene: &Scene, parameter: &Parameter, cotangent: &SceneDifferential) -> Vec<f32> {
    let Some(target) = parameter.target else {
        return Vec::new();
    };
    let camera = cotangent.camera.unwrap_or_default();
    match target {
        Target::VertexPositions(m) => match &cotangent.positions[m] {
            Some(positions) => positions.iter().flat_map(|p| p.to_array()).collect(),
            None => vec![0.0; parameter.len()],
        },
        Target::VertexNormals(m) => match &cotangent.given_normals[m] {
            Some(normals) => normals.iter().flat_map(|n| n.to_array()).collect(),
            None => vec![0.0; parameter.len()],
        },
        Target::ShapeToWorld(body) => {
            let mut sum = MatrixBar::zero();
            for m in body.meshes() {
                let present = scene.meshes[m].to_world;
                for (p, bar) in each_vertex(scene, Body::of(m), cotangent) {
                    sum.add_point(present, p, bar);
                }
                for (n, bar) in each_normal(scene, m, cotangent) {
                    sum.add_normal(present, n, bar);
                }
            }
            sum.rows().map(|v| v as f32).to_vec()
        }
        Target::ShapeTranslation(body) => {
            let sum: DVec3 = each_vertex(scene, body, cotangent)
                .map(|(_, bar)| bar)
                .sum();
            sum.as_vec3().to_array().to_vec()
        }
        Target::ShapeRotation(body) => {
            let center = pivot(&scene.meshes[body.meshes()]);
            let vertices = each_vertex(scene, body, cotangent);
            let torque: DVec3 = vertices.map(|(p, bar)| (p - center).cross(bar)).sum();
            let of_normals = body.meshes().map(|m| normal_torque(scene, m, cotangent));
            (torque + of_normals.sum::<DVec3>())
                .as_vec3()
                .to_array()
                .to_vec()
        }
        Target::ShapeScale(body) => {
            let center = pivot(&scene.meshes[body.meshes()]);
            let vertices = each_vertex(scene, body, cotangent);
            vec![vertices.map(|(p, bar)| (p - center).dot(bar)).sum::<f64>() as f32]
        }
        Target::SensorTranslation(_) => camera.translation.to_array().to_vec(),
        Target::SensorRotation(_) => camera.rotation.to_array().to_vec(),
        Target::SensorXFov(_) => vec![camera.x_fov_deg],
        Target::SensorToWorld(_) => {
            let matrix = DAffine3 {
                matrix3: DMat3::from_cols_array_2d(&camera.axes.map(|a| a.as_dvec3().to_array())),
                translation: camera.translation.as_dvec3(),
            };
            let mut rows = matrix_rows(matrix).map(|v| v as f32);
            rows[15] = 0.0;
            rows.to_vec()
        }
        Target::SensorPrincipalPoint { axis, .. } => vec![camera.principal_point_offset[axis]],
        Target::Texels(t) => match &cotangent.texels[t] {
            Some(texels) => {
                let channels = scene.textures[t].channels;
                texels
                    .iter()
                    .flat_map(|c| of_channels(*c, channels))
                    .collect()
            }
            None => vec![0.0; parameter.len()],
        },
        Target::Texel { texture, texel } => {
            let bar = cotangent.texels[texture].as_ref();
            let bar = bar.map_or([0.0; 3], |texels| texels[texel]);
            of_channels(bar, scene.textures[texture].channels).collect()
        }
        Target::ToUv(t) => cotangent.to_uv[t].unwrap_or_default().to_vec(),
        Target::EnvironmentScale => vec![cotangent.environment.unwrap_or_default().scale],
        Target::EnvironmentRotation => {
            let environment = cotangent.environment.unwrap_or_default();
            environment.rotation.to_array().to_vec()
        }
        Target::DeltaLightPosition(i) | Target::DeltaLightTranslation(i) => cotangent.delta_lights
            [i]
            .unwrap_or_default()
            .to_array()
            .to_vec(),
    }
}

/// One channel is held three times, and moves all of them.
fn of_channels(bar: [f32; 3], channels: usize) -> impl Iterator<Item = f32> {
    let bar = match channels {
        1 => [bar.iter().sum(), 0.0, 0.0],
        _ => bar,
    };
    bar.into_iter().take(channels)
}

fn want_positions(out: &mut SceneDifferential, scene: &Scene, m: usize) {
    let vertices = scene.meshes[m].positions.len();
    out.positions[m].get_or_insert_with(|| vec![Vec3::ZERO; vertices]);
}

/// Position and its cotangent.
fn each_vertex<'a>(
    scene: &'a Scene,
    body: Body,
    cotangent: &'a SceneDifferential,
) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
    body.meshes().flat_map(|m| {
        let bars = cotangent.positions[m].as_deref().unwrap_or_default();
        let positions = scene.meshes[m].positions.iter();
        positions
            .zip(bars)
            .map(|(p, bar)| (p.as_dvec3(), bar.as_dvec3()))
    })
}

/// Normal and its cotangent, of a mesh whose normals are data of their own.
fn each_normal<'a>(
    scene: &'a Scene,
    m: usize,
    cotangent: &'a SceneDifferential,
) -> impl Iterator<Item = (DVec3, DVec3)> + 'a {
    let (normals, bars) = match (&scene.meshes[m].normals, &cotangent.given_normals[m]) {
        (Normals::Given(normals), Some(bars)) => (normals.as_slice(), bars.as_slice()),
        _ => (&[][..], &[][..]),
    };
    let pairs = normals.iter().zip(bars);
    pairs.map(|(n, bar)| (n.as_dvec3(), bar.as_dvec3()))
}

fn normal_torque(scene: &Scene, m: usize, cotangent: &SceneDifferential) -> DVec3 {
    let normals = each_normal(scene, m, cotangent);
    normals.map(|(n, bar)| n.cross(bar)).sum()
}
