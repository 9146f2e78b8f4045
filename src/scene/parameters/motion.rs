//! Moving a scene by finite amounts: setting values, and steps for finite differences.

use super::parameter::Parameter;
use super::target::Target;
use super::to_uv::{from_rows, rows};
use super::to_world::from_matrix_rows;
use crate::scene::data::{Body, DeltaLightKind, EnvironmentMap, Mesh, Normals, Rgb, Scene};
use crate::scene::error::SceneError;
use crate::scene::rigid::is_rigid;
use crate::scene::vertex_normals::vertex_normals;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::collections::BTreeMap;

/// The point that rotations and scalings of meshes leave in place: their bounding-box centre.
pub fn pivot(meshes: &[Mesh]) -> DVec3 {
    let positions = meshes.iter().flat_map(|m| &m.positions);
    let mut positions = positions.map(|p| p.as_dvec3());
    let first = positions.next().unwrap_or_default();
    let (low, high) = positions.fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
    (low + high) / 2.0
}

/// A rotation by the length of `vector` (radians) about it.
fn rotation(vector: DVec3) -> DQuat {
    DQuat::from_scaled_axis(vector)
}

/// What moves one mesh: v ↦ c + scale·R·(v + offset − c) + translation, with a turn about the
/// mesh's own middle and one about that of the instance it is part of.
#[derive(Default)]
struct MeshMotion {
    /// One a vertex, or none at all.
    offsets: Vec<DVec3>,
    translation: DVec3,
    turns: Vec<Turn>,
}

/// A rotation and scaling about a point.
struct Turn {
    center: DVec3,
    rotation: DVec3,
    scale: f64,
}

impl Turn {
    fn place(&self, p: DVec3) -> DVec3 {
        self.center + rotation(self.rotation) * (p - self.center) * self.scale
    }
}

impl MeshMotion {
    /// The turn about this point, which does nothing if it is new.
    fn about(&mut self, center: DVec3) -> &mut Turn {
        let known = self.turns.iter().position(|t| t.center == center);
        let at = known.unwrap_or_else(|| {
            self.turns.push(Turn {
                center,
                rotation: DVec3::ZERO,
                scale: 1.0,
            });
            self.turns.len() - 1
        });
        &mut self.turns[at]
    }

    fn move_mesh(&self, mesh: &mut Mesh) {
        for turn in &self.turns {
            let about = DAffine3::from_translation(turn.center);
            let turned = DAffine3::from_scale_rotation_translation(
                DVec3::splat(turn.scale),
                rotation(turn.rotation),
                DVec3::ZERO,
            );
            mesh.to_world = about * turned * about.inverse() * mesh.to_world;
        }
        mesh.to_world.translation += self.translation;
        for (i, position) in mesh.positions.iter_mut().enumerate() {
            let offset = self.offsets.get(i).copied().unwrap_or_default();
            let turns = self.turns.iter();
            let p = turns.fold(position.as_dvec3() + offset, |p, turn| turn.place(p));
            *position = (p + self.translation).as_vec3();
        }
        match &mut mesh.normals {
            Normals::Flat => {}
            Normals::Given(normals) => {
                for turn in self.turns.iter().filter(|t| t.rotation != DVec3::ZERO) {
                    for normal in normals.iter_mut() {
                        *normal = (rotation(turn.rotation) * normal.as_dvec3()).as_vec3();
                    }
                }
            }
            Normals::Computed(normals) => {
                *normals = vertex_normals(&mesh.positions, &mesh.triangles);
            }
        }
    }
}

/// Moves all meshes of a body alike.
fn move_body(scene: &mut Scene, body: Body, motion: &MeshMotion) {
    for mesh in &mut scene.meshes[body.meshes()] {
        motion.move_mesh(mesh);
    }
}

/// The scene at θ + `step`·direction, for finite differences. Several directions add up. A
/// direction has as many values as the parameter, or those of its last axis. Arithmetic is in
/// double precision; rotations are by the rotation vector `step`·direction, not by its first-order
/// term.
// Long: one arm for every kind of parameter.
pub fn displace<V: AsRef<[f32]>>(
    scene: &Scene,
    directions: &[(Parameter, V)],
    step: f64,
) -> Result<Scene, SceneError> {
    let mut out = scene.clone();
    let mut meshes: BTreeMap<usize, MeshMotion> = BTreeMap::new();
    // Sums first: two rotations of one thing are one rotation by the sum.
    let mut sensor_rotations: BTreeMap<usize, DVec3> = BTreeMap::new();
    let mut environment_rotation = DVec3::ZERO;
    for (parameter, values) in directions {
        let target = parameter.target()?;
        let values = parameter.broadcast(values.as_ref())?;
        let values: Vec<f64> = values.iter().map(|&v| f64::from(v) * step).collect();
        let first = DVec3::new(value(&values, 0), value(&values, 1), value(&values, 2));
        match target {
            Target::VertexPositions(m) => {
                let motion = meshes.entry(m).or_default();
                motion.offsets.resize(values.len() / 3, DVec3::ZERO);
                for (offset, part) in motion.offsets.iter_mut().zip(values.chunks_exact(3)) {
                    *offset += DVec3::from_slice(part);
                }
            }
            Target::VertexNormals(m) => shift_normals(&mut out.meshes[m], &values),
            Target::ShapeToWorld(body) => {
                let change = from_matrix_rows(&values);
                for m in body.meshes() {
                    let to = sum(scene.meshes[m].to_world, change);
                    set_to_world(&mut out.meshes[m], to, &parameter.key)?;
                }
            }
            Target::ShapeTranslation(body) => {
                for m in body.meshes() {
                    meshes.entry(m).or_default().translation += first;
                }
            }
            Target::ShapeRotation(body) => {
                let center = pivot(&scene.meshes[body.meshes()]);
                for m in body.meshes() {
                    meshes.entry(m).or_default().about(center).rotation += first;
                }
            }
            Target::ShapeScale(body) => {
                let center = pivot(&scene.meshes[body.meshes()]);
                for m in body.meshes() {
                    meshes.entry(m).or_default().about(center).scale += first.x;
                }
            }
            Target::SensorTranslation(s) => {
                let to_world = &mut out.sensors[s].to_world;
                let moved = to_world.translation.as_dvec3() + first;
                to_world.translation = moved.as_vec3().into();
            }
            Target::SensorRotation(s) => *sensor_rotations.entry(s).or_default() += first,
            Target::SensorXFov(s) => {
                let fov_deg = f64::from(out.sensors[s].x_fov_rad).to_degrees() + first.x;
                set_x_fov(&mut out, &parameter.key, s, fov_deg)?;
            }
            Target::SensorToWorld(s) => {
                let moved = sum(sensor_to_world(&out, s), from_matrix_rows(&values));
                out.sensors[s].to_world = moved.as_affine3a();
            }
            Target::SensorPrincipalPoint { sensor, axis } => {
                out.sensors[sensor].principal_point_offset[axis] += first.x as f32;
            }
            Target::Texels(t) => {
                let texture = &mut out.textures[t];
                let offsets = values.chunks_exact(texture.channels);
                for (texel, offset) in texture.texels.iter_mut().zip(offsets) {
                    shift(texel, offset);
                }
            }
            Target::Texel { texture, texel } => {
                shift(&mut out.textures[texture].texels[texel], &values);
            }
            Target::ToUv(t) => {
                if let Some(to_uv) = out.textures[t].layout.to_uv_mut() {
                    let mut numbers = rows(*to_uv);
                    for (number, offset) in numbers.iter_mut().zip(&values) {
                        *number = (f64::from(*number) + offset) as f32;
                    }
                    *to_uv = from_rows(numbers);
                }
            }
            Target::EnvironmentScale => {
                if let Some(map) = environment_map(&mut out) {
                    map.scale = (f64::from(map.scale) + first.x) as f32;
                }
            }
            Target::EnvironmentRotation => environment_rotation += first,
            Target::DeltaLightPosition(i) | Target::DeltaLightTranslation(i) => {
                translate_light(&mut out, i, first);
            }
        }
    }
    for (m, motion) in meshes {
        motion.move_mesh(&mut out.meshes[m]);
    }
    for (s, vector) in sensor_rotations {
        rotate_sensor(&mut out, s, vector);
    }
    if environment_rotation != DVec3::ZERO {
        rotate_environment(&mut out, environment_rotation);
    }
    Ok(out)
}

fn sensor_to_world(scene: &Scene, s: usize) -> DAffine3 {
    let to_world = scene.sensors[s].to_world;
    let m = to_world.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|axis| axis.as_dvec3());
    DAffine3 {
        matrix3: DMat3::from_cols(columns[0], columns[1], columns[2]),
        translation: to_world.translation.as_dvec3(),
    }
}

fn sum(a: DAffine3, b: DAffine3) -> DAffine3 {
    DAffine3 {
        matrix3: a.matrix3 + b.matrix3,
        translation: a.translation + b.translation,
    }
}

/// Puts a mesh where another matrix takes it. A mirror image is refused: its triangles would turn.
fn set_to_world(mesh: &mut Mesh, to_world: DAffine3, key: &str) -> Result<(), SceneError> {
    let before = mesh.to_world.matrix3.determinant();
    let all = to_world * mesh.to_world.inverse();
    if to_world.matrix3.determinant() * before <= 0.0 || !all.is_finite() {
        let what = format!("{key}: this to_world flattens the shape, or makes it its mirror image");
        return Err(SceneError::parameter(what));
    }
    let normal_matrix = all.matrix3.inverse().transpose();
    for position in &mut mesh.positions {
        *position = all.transform_point3(position.as_dvec3()).as_vec3();
    }
    match &mut mesh.normals {
        Normals::Flat => {}
        Normals::Given(normals) => {
            for normal in normals {
                let turned = (normal_matrix * normal.as_dvec3()).normalize_or_zero();
                *normal = turned.as_vec3();
            }
        }
        Normals::Computed(normals) => {
            *normals = vertex_normals(&mesh.positions, &mesh.triangles);
        }
    }
    mesh.to_world = to_world;
    Ok(())
}

fn shift_normals(mesh: &mut Mesh, by: &[f64]) {
    if let Normals::Given(normals) = &mut mesh.normals {
        for (normal, by) in normals.iter_mut().zip(by.chunks_exact(3)) {
            *normal = (normal.as_dvec3() + DVec3::from_slice(by)).as_vec3();
        }
    }
}

/// Adds three numbers, or one to all three.
fn shift(texel: &mut Rgb, offset: &[f64]) {
    for (c, number) in texel.iter_mut().enumerate() {
        *number = (f64::from(*number) + offset[c.min(offset.len() - 1)]) as f32;
    }
}

fn environment_map(scene: &mut Scene) -> Option<&mut EnvironmentMap> {
    scene.environment.as_mut().and_then(|e| e.map.as_mut())
}

fn rotate_environment(scene: &mut Scene, vector: DVec3) {
    if let Some(map) = environment_map(scene) {
        let turned = DMat3::from_quat(rotation(vector)) * map.to_world.as_dmat3();
        map.to_world = turned.as_mat3();
    }
}

fn translate_light(scene: &mut Scene, i: usize, by: DVec3) {
    if let DeltaLightKind::Point { position } = &mut scene.delta_lights[i].kind {
        *position = (position.as_dvec3() + by).as_vec3();
    }
}

fn value(values: &[f64], at: usize) -> f64 {
    values.get(at).copied().unwrap_or_default()
}

fn rotate_sensor(scene: &mut Scene, s: usize, vector: DVec3) {
    let matrix = &mut scene.sensors[s].to_world.matrix3;
    let turn = rotation(vector);
    let turned = [matrix.x_axis, matrix.y_axis, matrix.z_axis]
        .map(|axis| (turn * axis.as_dvec3()).as_vec3());
    *matrix = glam::Mat3::from_cols(turned[0], turned[1], turned[2]).into();
}

fn set_x_fov(scene: &mut Scene, key: &str, s: usize, fov_deg: f64) -> Result<(), SceneError> {
    if !(fov_deg > 0.0 && fov_deg < 180.0) {
        let what = format!("{key}: an opening angle is between 0 and 180 degrees, not {fov_deg}");
        return Err(SceneError::parameter(what));
    }
    scene.sensors[s].x_fov_rad = fov_deg.to_radians() as f32;
    Ok(())
}

/// Sets a parameter. Motions (translation, rotation, scale) are applied to the scene as it is: a
/// translation by the value, a scaling by the factor. Computed normals follow.
// Long: one arm for every kind of parameter.
pub fn apply(scene: &mut Scene, parameter: &Parameter, values: &[f32]) -> Result<(), SceneError> {
    let target = parameter.target()?;
    let values = parameter.broadcast(values)?;
    let refuse = |what: &str| Err(SceneError::parameter(format!("{}: {what}", parameter.key)));
    let first = DVec3::from([0, 1, 2].map(|i| values.get(i).map_or(0.0, |&v| f64::from(v))));
    let mut motion = MeshMotion::default();
    match target {
        Target::VertexPositions(m) => {
            let mesh = &mut scene.meshes[m];
            for (position, value) in mesh.positions.iter_mut().zip(values.chunks_exact(3)) {
                *position = glam::Vec3::from_slice(value);
            }
            // Recomputes the normals that follow the positions.
            motion.move_mesh(mesh);
        }
        Target::VertexNormals(m) => {
            if let Normals::Given(normals) = &mut scene.meshes[m].normals {
                for (normal, value) in normals.iter_mut().zip(values.chunks_exact(3)) {
                    *normal = glam::Vec3::from_slice(value);
                }
            }
        }
        Target::ShapeToWorld(body) => {
            let rows: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
                return refuse("the last row is 0, 0, 0, 1");
            }
            for mesh in &mut scene.meshes[body.meshes()] {
                set_to_world(mesh, from_matrix_rows(&rows), &parameter.key)?;
            }
        }
        Target::ShapeTranslation(body) => {
            motion.translation = first;
            move_body(scene, body, &motion);
        }
        Target::ShapeRotation(body) => {
            motion.about(pivot(&scene.meshes[body.meshes()])).rotation = first;
            move_body(scene, body, &motion);
        }
        Target::ShapeScale(body) => {
            if first.x <= 0.0 {
                return refuse("a scale is greater than zero");
            }
            motion.about(pivot(&scene.meshes[body.meshes()])).scale = first.x;
            move_body(scene, body, &motion);
        }
        Target::SensorTranslation(s) => {
            scene.sensors[s].to_world.translation += glam::Vec3A::from(first.as_vec3());
        }
        Target::SensorRotation(s) => rotate_sensor(scene, s, first),
        Target::SensorXFov(s) => set_x_fov(scene, &parameter.key, s, first.x)?,
        Target::SensorToWorld(s) => {
            let rows: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            let to_world = from_matrix_rows(&rows);
            if rows[12..] != [0.0, 0.0, 0.0, 1.0] || !is_rigid(to_world.matrix3) {
                return refuse(
                    "a camera's to_world rotates and translates, and its last row is 0, 0, 0, 1",
                );
            }
            scene.sensors[s].to_world = to_world.as_affine3a();
        }
        Target::SensorPrincipalPoint { sensor, axis } => {
            scene.sensors[sensor].principal_point_offset[axis] = first.x as f32;
        }
        Target::Texels(t) => {
            let texture = &mut scene.textures[t];
            check_limits(parameter, texture.limits, &values)?;
            let values = values.chunks_exact(texture.channels);
            for (texel, value) in texture.texels.iter_mut().zip(values) {
                *texel = colour(value);
            }
        }
        Target::Texel { texture, texel } => {
            let texture = &mut scene.textures[texture];
            check_limits(parameter, texture.limits, &values)?;
            texture.texels[texel] = colour(&values);
        }
        Target::ToUv(t) => {
            let Ok(numbers) = <[f32; 6]>::try_from(values) else {
                return refuse("it has six numbers");
            };
            if let Some(to_uv) = scene.textures[t].layout.to_uv_mut() {
                *to_uv = from_rows(numbers);
            }
        }
        Target::EnvironmentScale => {
            if first.x < 0.0 {
                return refuse("a scale of radiance is at least zero");
            }
            if let Some(map) = environment_map(scene) {
                map.scale = first.x as f32;
            }
        }
        Target::EnvironmentRotation => rotate_environment(scene, first),
        Target::DeltaLightPosition(i) => {
            if let DeltaLightKind::Point { position } = &mut scene.delta_lights[i].kind {
                *position = first.as_vec3();
            }
        }
        Target::DeltaLightTranslation(i) => translate_light(scene, i, first),
    }
    Ok(())
}

/// Three numbers, or one three times.
fn colour(value: &[f32]) -> Rgb {
    [0, 1, 2].map(|c: usize| value[c.min(value.len() - 1)])
}

fn check_limits(
    parameter: &Parameter,
    [low, high]: [f32; 2],
    values: &[f32],
) -> Result<(), SceneError> {
    match values.iter().find(|v| !(low..=high).contains(*v)) {
        None => Ok(()),
        Some(bad) => Err(SceneError::parameter(format!(
            "{}: {bad} is not between {low} and {high}",
            parameter.key
        ))),
    }
}
