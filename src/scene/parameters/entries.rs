//! All keys of a scene, with what they stand for.

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
}

/// Listed, but not differentiable.
enum Fixed {
    None,
    Faces(usize),
    Normals(usize),
    Numbers(Vec<f64>),
}

impl Entry {
    fn of(key: String, shape: &[usize], target: Target) -> Self {
        Self {
            key,
            aliases: Vec::new(),
            shape: shape.to_vec(),
            target: Some(target),
            fixed: Fixed::None,
        }
    }

    fn fixed(key: String, shape: &[usize], fixed: Fixed) -> Self {
        Self {
            key,
            aliases: Vec::new(),
            shape: shape.to_vec(),
            target: None,
            fixed,
        }
    }

    fn numbers(key: String, numbers: Vec<f64>) -> Self {
        let shape = [numbers.len()];
        Self::fixed(key, &shape, Fixed::Numbers(numbers))
    }

    /// What the parameter is now.
    pub fn value(&self, scene: &Scene) -> Value {
        let colour = |c: &[f32; 3]| Value::Numbers(c.iter().map(|&v| f64::from(v)).collect());
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
                | Target::SensorRotation(_),
            ) => Value::Numbers(vec![0.0; 3]),
            Some(Target::SensorXFov(s)) => {
                Value::Numbers(vec![f64::from(scene.sensors[s].x_fov_rad).to_degrees()])
            }
            Some(Target::Reflectance(m)) => colour(&scene.materials[m].reflectance),
            Some(Target::Radiance(l)) => colour(&scene.area_lights[l].radiance),
            Some(Target::EnvironmentRadiance) => match &scene.environment {
                Some(environment) => colour(&environment.radiance),
                None => Value::Numbers(Vec::new()),
            },
            None => match &self.fixed {
                Fixed::None => Value::Numbers(Vec::new()),
                Fixed::Numbers(numbers) => Value::Numbers(numbers.clone()),
                Fixed::Faces(m) => {
                    let all = scene.meshes[*m].triangles.iter().flatten();
                    range(all.map(|&i| f64::from(i)))
                }
                Fixed::Normals(m) => {
                    let all = scene.meshes[*m].normals.vertex().unwrap_or_default();
                    range(all.iter().flat_map(|n| n.to_array()).map(f64::from))
                }
            },
        }
    }
}

fn range(values: impl Iterator<Item = f64>) -> Value {
    let (min, max) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| {
        (min.min(v), max.max(v))
    });
    Value::Range { min, max }
}

/// Every key: shape by shape with the material and light that only it has, then shared materials, the
/// environment, the sensors.
pub(super) fn entries(scene: &Scene) -> Vec<Entry> {
    let mut out = Vec::new();
    let users = material_users(scene);
    let mut listed = vec![false; scene.materials.len()];
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
        let own = format!("{id}.bsdf");
        if scene.materials[mesh.material].key == own && !listed[mesh.material] {
            listed[mesh.material] = true;
            out.push(reflectance(scene, mesh.material, &users));
        }
        if let Some(l) = mesh.area_light {
            let key = format!("{}.radiance.value", scene.area_lights[l].key);
            out.push(Entry::of(key, &[3], Target::Radiance(l)));
        }
        out.push(Entry::of(
            format!("{id}.translation"),
            &[3],
            Target::ShapeTranslation(m),
        ));
        out.push(Entry::of(
            format!("{id}.rotation"),
            &[3],
            Target::ShapeRotation(m),
        ));
        out.push(Entry::of(
            format!("{id}.scale"),
            &[1],
            Target::ShapeScale(m),
        ));
        let faces = [mesh.triangles.len(), 3];
        out.push(Entry::fixed(format!("{id}.faces"), &faces, Fixed::Faces(m)));
        if !matches!(mesh.normals, Normals::Flat) {
            out.push(Entry::fixed(
                format!("{id}.vertex_normals"),
                &vertices,
                Fixed::Normals(m),
            ));
        }
    }
    for m in (0..scene.materials.len()).filter(|&m| !listed[m]) {
        out.push(reflectance(scene, m, &users));
    }
    if let Some(environment) = &scene.environment {
        let key = format!("{}.radiance.value", environment.key);
        out.push(Entry::of(key, &[3], Target::EnvironmentRadiance));
    }
    for (s, sensor) in scene.sensors.iter().enumerate() {
        sensor_entries(s, sensor, &mut out);
    }
    out
}

/// The ids of the shapes of each material.
fn material_users(scene: &Scene) -> Vec<Vec<&str>> {
    let mut users = vec![Vec::new(); scene.materials.len()];
    for mesh in &scene.meshes {
        users[mesh.material].push(mesh.id.as_str());
    }
    users
}

fn reflectance(scene: &Scene, m: usize, users: &[Vec<&str>]) -> Entry {
    let material = &scene.materials[m];
    // Mitsuba puts the colour of a two-sided bsdf one level down; both spellings are taken for both kinds.
    let (listed, other) = match material.two_sided {
        true => (".brdf_0.reflectance.value", ".reflectance.value"),
        false => (".reflectance.value", ".brdf_0.reflectance.value"),
    };
    let key = format!("{}{listed}", material.key);
    let mut entry = Entry::of(key, &[3], Target::Reflectance(m));
    entry.aliases.push(format!("{}{other}", material.key));
    for id in &users[m] {
        for tail in [listed, other] {
            let alias = format!("{id}.bsdf{tail}");
            if alias != entry.key && !entry.aliases.contains(&alias) {
                entry.aliases.push(alias);
            }
        }
    }
    entry
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
        out.push(Entry::numbers(format!("{id}.{name}"), numbers));
    }
    let to_world = Fixed::Numbers(rows);
    out.push(Entry::fixed(format!("{id}.to_world"), &[4, 4], to_world));
}
