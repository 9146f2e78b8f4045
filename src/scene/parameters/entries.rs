//! All keys of a scene, with what they stand for.

use super::surfaces::{self, Slots};
use super::{Target, Value};
use crate::scene::data::{Normals, Scene, Sensor};

/// A parameter before its present value is looked up, which for a mesh takes time.
pub(super) struct Entry {
    pub key: String,
    pub aliases: Vec<String>,
    pub shape: Vec<usize>,
    pub target: Option<Target>,
    /// Of parameters without a target.
    fixed: Fixed,
    /// Why there is no target, if more can be said than that there is none.
    pub refusal: Option<&'static str>,
}

/// Listed, but not differentiable.
enum Fixed {
    None,
    Faces(usize),
    Normals(usize),
    Uvs(usize),
    Numbers(Vec<f64>),
}

impl Entry {
    pub fn of(key: String, shape: &[usize], target: Target) -> Self {
        Self {
            key,
            aliases: Vec::new(),
            shape: shape.to_vec(),
            target: Some(target),
            fixed: Fixed::None,
            refusal: None,
        }
    }

    fn fixed(key: String, shape: &[usize], fixed: Fixed) -> Self {
        Self {
            key,
            aliases: Vec::new(),
            shape: shape.to_vec(),
            target: None,
            fixed,
            refusal: None,
        }
    }

    /// Numbers that cannot be differentiated.
    pub fn numbers(key: String, shape: &[usize], numbers: Vec<f64>) -> Self {
        Self::fixed(key, shape, Fixed::Numbers(numbers))
    }

    /// What the parameter is now.
    pub fn value(&self, scene: &Scene) -> Value {
        match self.target {
            Some(Target::VertexPositions(m)) => {
                let all = scene.meshes[m].positions.iter().flat_map(|p| p.to_array());
                range(all.map(f64::from))
            }
            Some(Target::ShapeScale(_)) => Value::Numbers(vec![1.0]),
            Some(
                Target::ShapeTranslation(_)
                | Target::ShapeRotation(_)
                | Target::SensorTranslation(_)
                | Target::SensorRotation(_)
                | Target::EnvironmentRotation
                | Target::DeltaLightTranslation(_),
            ) => Value::Numbers(vec![0.0; 3]),
            Some(Target::SensorXFov(s)) => {
                Value::Numbers(vec![f64::from(scene.sensors[s].x_fov_rad).to_degrees()])
            }
            Some(
                target @ (Target::Texels(_)
                | Target::Texel { .. }
                | Target::ToUv(_)
                | Target::EnvironmentScale
                | Target::DeltaLightPosition(_)),
            ) => surfaces::value(scene, target),
            None => match &self.fixed {
                Fixed::None => Value::Numbers(Vec::new()),
                Fixed::Numbers(numbers) => Value::Numbers(numbers.clone()),
                Fixed::Faces(m) => {
                    let all = scene.meshes[*m].triangles.iter().flatten();
                    range(all.map(|&i| f64::from(i)))
                }
                Fixed::Uvs(m) => {
                    let all = scene.meshes[*m].uvs.iter().flat_map(|uv| uv.to_array());
                    range(all.map(f64::from))
                }
                Fixed::Normals(m) => {
                    let all = scene.meshes[*m].normals.vertex().unwrap_or_default();
                    range(all.iter().flat_map(|n| n.to_array()).map(f64::from))
                }
            },
        }
    }
}

pub(super) fn range(values: impl Iterator<Item = f64>) -> Value {
    let (min, max) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| {
        (min.min(v), max.max(v))
    });
    Value::Range { min, max }
}

/// Every key: shape by shape with the material and light that only it has, then shared materials, other textures and
/// lights, the environment, the sensors.
pub(super) fn entries(scene: &Scene) -> Vec<Entry> {
    let mut out = Vec::new();
    let mut slots = Slots::new(scene);
    for (m, mesh) in scene.meshes.iter().enumerate() {
        let id = &mesh.id;
        let vertices = [mesh.positions.len(), 3];
        let mut positions = Entry::of(
            format!("{id}.vertex_positions"),
            &vertices,
            Target::VertexPositions(m),
        );
        positions.aliases.push(format!("{id}.positions"));
        out.push(positions);
        if scene.materials[mesh.material].key == format!("{id}.bsdf") {
            slots.material(mesh.material, &mut out);
        }
        if let Some(l) = mesh.area_light {
            slots.texture(scene.area_lights[l].radiance, &mut out);
        }
        for (name, count, target) in [
            ("translation", 3, Target::ShapeTranslation(m)),
            ("rotation", 3, Target::ShapeRotation(m)),
            ("scale", 1, Target::ShapeScale(m)),
        ] {
            out.push(Entry::of(format!("{id}.{name}"), &[count], target));
        }
        let faces = [mesh.triangles.len(), 3];
        out.push(Entry::fixed(format!("{id}.faces"), &faces, Fixed::Faces(m)));
        if !matches!(mesh.normals, Normals::Flat) {
            out.push(Entry::fixed(
                format!("{id}.vertex_normals"),
                &vertices,
                Fixed::Normals(m),
            ));
        }
        if !mesh.uvs.is_empty() {
            let coordinates = [mesh.uvs.len(), 2];
            out.push(Entry::fixed(
                format!("{id}.vertex_texcoords"),
                &coordinates,
                Fixed::Uvs(m),
            ));
        }
    }
    for m in 0..scene.materials.len() {
        slots.material(m, &mut out);
    }
    for light in 0..scene.delta_lights.len() {
        slots.delta_light(light, &mut out);
    }
    slots.environment(&mut out);
    for t in 0..scene.textures.len() {
        slots.texture(t, &mut out);
    }
    for (s, sensor) in scene.sensors.iter().enumerate() {
        sensor_entries(s, sensor, &mut out);
    }
    out
}

fn sensor_entries(s: usize, sensor: &Sensor, out: &mut Vec<Entry>) {
    let id = &sensor.id;
    out.push(Entry::of(
        format!("{id}.translation"),
        &[3],
        Target::SensorTranslation(s),
    ));
    out.push(Entry::of(
        format!("{id}.rotation"),
        &[3],
        Target::SensorRotation(s),
    ));
    out.push(Entry::of(
        format!("{id}.x_fov"),
        &[1],
        Target::SensorXFov(s),
    ));
    let film = &sensor.film;
    let pair = |a: u32, b: u32| vec![f64::from(a), f64::from(b)];
    let offset = sensor.principal_point_offset;
    let matrix = glam::Mat4::from(sensor.to_world).transpose();
    let rows: Vec<f64> = matrix
        .to_cols_array()
        .iter()
        .map(|&v| f64::from(v))
        .collect();
    let fixed = [
        ("near_clip", vec![f64::from(sensor.near_clip)]),
        ("far_clip", vec![f64::from(sensor.far_clip)]),
        ("principal_point_offset_x", vec![f64::from(offset.x)]),
        ("principal_point_offset_y", vec![f64::from(offset.y)]),
        ("film.size", pair(film.width, film.height)),
        ("film.crop_size", film.crop_size.map(f64::from).to_vec()),
        ("film.crop_offset", film.crop_offset.map(f64::from).to_vec()),
    ];
    for (name, numbers) in fixed {
        let shape = [numbers.len()];
        out.push(Entry::numbers(format!("{id}.{name}"), &shape, numbers));
    }
    out.push(Entry::numbers(format!("{id}.to_world"), &[4, 4], rows));
}
