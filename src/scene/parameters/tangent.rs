//! Forward: a direction in parameters becomes a motion of everything in the scene.

use super::find;
use super::motion::pivot;
use super::target::Target;
use super::to_world::{from_matrix_rows, normal_change, velocity};
use crate::scene::data::{Normals, Scene};
use crate::scene::differential::{CameraDifferential, SceneDifferential};
use crate::scene::error::SceneError;
use glam::{DVec3, Vec3};

/// dScene/dθ for the sum of `directions`, each a key and its values (as many as the parameter has,
/// or those of its last axis for all rows), seen from sensor `sensor`.
pub fn tangent<K: AsRef<str>, V: AsRef<[f32]>>(
    scene: &Scene,
    directions: &[(K, V)],
    sensor: usize,
) -> Result<SceneDifferential, SceneError> {
    let mut out = SceneDifferential::none(scene);
    for (key, values) in directions {
        let parameter = find(scene, key.as_ref())?;
        let target = parameter.target()?;
        parameter.check_sensor(scene, sensor)?;
        let values = parameter.broadcast(values.as_ref())?;
        add(&mut out, scene, target, &values);
    }
    Ok(out)
}

/// Adds one direction; `values` has the parameter's length.
// Long: one arm for every kind of parameter.
fn add(out: &mut SceneDifferential, scene: &Scene, target: Target, values: &[f32]) {
    let vector = |at: usize| {
        let part = values.get(3 * at..3 * at + 3).unwrap_or(&[0.0; 3]);
        Vec3::from_slice(part)
    };
    match target {
        Target::VertexPositions(m) => add_positions(out, scene, m, |i, _| vector(i)),
        Target::VertexNormals(m) => {
            add_positions(out, scene, m, |_, _| Vec3::ZERO);
            add_normals(out, scene, m, |i, _| vector(i));
        }
        Target::ShapeToWorld(body) => {
            let rows: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            let change = from_matrix_rows(&rows);
            for m in body.meshes() {
                let field = velocity(change, scene.meshes[m].to_world);
                add_positions(out, scene, m, |_, p| field.transform_point3(p).as_vec3());
                add_normals(out, scene, m, |_, n| {
                    normal_change(field.matrix3, n).as_vec3()
                });
            }
        }
        Target::ShapeTranslation(body) => {
            for m in body.meshes() {
                add_positions(out, scene, m, |_, _| vector(0));
            }
        }
        Target::ShapeRotation(body) => {
            let (axis, center) = (vector(0).as_dvec3(), pivot(&scene.meshes[body.meshes()]));
            for m in body.meshes() {
                add_positions(out, scene, m, |_, p| axis.cross(p - center).as_vec3());
                add_normals(out, scene, m, |_, n| axis.cross(n).as_vec3());
            }
        }
        Target::ShapeScale(body) => {
            let center = pivot(&scene.meshes[body.meshes()]);
            let factor = f64::from(values[0]);
            for m in body.meshes() {
                add_positions(out, scene, m, |_, p| ((p - center) * factor).as_vec3());
            }
        }
        Target::SensorTranslation(_) => camera(out).translation += vector(0),
        Target::SensorRotation(_) => camera(out).rotation += vector(0),
        Target::SensorXFov(_) => camera(out).x_fov_deg += values[0],
        Target::SensorToWorld(_) => {
            let rows: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            let change = from_matrix_rows(&rows);
            let camera = camera(out);
            camera.translation += change.translation.as_vec3();
            for (axis, column) in camera.axes.iter_mut().enumerate() {
                *column += change.matrix3.col(axis).as_vec3();
            }
        }
        Target::SensorPrincipalPoint { axis, .. } => {
            camera(out).principal_point_offset[axis] += values[0];
        }
        Target::Texels(t) => {
            let channels = scene.textures[t].channels;
            let texels = out.want_texels(scene, t);
            for (texel, value) in texels.iter_mut().zip(values.chunks_exact(channels)) {
                add_colour(texel, value);
            }
        }
        Target::Texel { texture, texel } => {
            add_colour(&mut out.want_texels(scene, texture)[texel], values);
        }
        Target::ToUv(t) => {
            let rows = out.to_uv[t].get_or_insert_default();
            for (row, value) in rows.iter_mut().zip(values) {
                *row += value;
            }
        }
        Target::EnvironmentScale => out.environment.get_or_insert_default().scale += values[0],
        Target::EnvironmentRotation => {
            out.environment.get_or_insert_default().rotation += vector(0);
        }
        Target::DeltaLightPosition(i) | Target::DeltaLightTranslation(i) => {
            *out.delta_lights[i].get_or_insert_default() += vector(0);
        }
    }
}

/// Adds three numbers, or one to all three.
fn add_colour(texel: &mut [f32; 3], value: &[f32]) {
    for (c, number) in texel.iter_mut().enumerate() {
        *number += value[c.min(value.len() - 1)];
    }
}

fn add_positions(
    out: &mut SceneDifferential,
    scene: &Scene,
    m: usize,
    motion: impl Fn(usize, DVec3) -> Vec3,
) {
    let positions = &scene.meshes[m].positions;
    let moved = out.positions[m].get_or_insert_with(|| vec![Vec3::ZERO; positions.len()]);
    for (i, (moved, position)) in moved.iter_mut().zip(positions).enumerate() {
        *moved += motion(i, position.as_dvec3());
    }
}

/// Normals that are computed follow the positions.
fn add_normals(
    out: &mut SceneDifferential,
    scene: &Scene,
    m: usize,
    change: impl Fn(usize, DVec3) -> Vec3,
) {
    if let Normals::Given(normals) = &scene.meshes[m].normals {
        let moved = out.given_normals[m].get_or_insert_with(|| vec![Vec3::ZERO; normals.len()]);
        for (i, (moved, normal)) in moved.iter_mut().zip(normals).enumerate() {
            *moved += change(i, normal.as_dvec3());
        }
    }
}

fn camera(out: &mut SceneDifferential) -> &mut CameraDifferential {
    out.camera.get_or_insert_default()
}
