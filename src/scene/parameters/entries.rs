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
            Some(Target::Texels(t)) => {
                let texture = &scene.textures[t];
                let all = texture.texels.iter();
                let numbers = all.flat_map(|c| c[..texture.channels].iter().map(|&v| f64::from(v)));
                if texture.texels.len() == 1 {
                    Value::Numbers(numbers.collect())
                } else {
                    range(numbers)
                }
            }
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
            out.extend(material(scene, mesh.material, &users));
        }
        if let Some(l) = mesh.area_light {
            out.push(texels(scene, scene.area_lights[l].radiance));
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
        out.extend(material(scene, m, &users));
    }
    if let Some(environment) = &scene.environment {
        out.push(texels(scene, environment.radiance));
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

/// The values of a texture.
fn texels(scene: &Scene, t: usize) -> Entry {
    let texture = &scene.textures[t];
    let key = format!("{}.value", texture.key);
    Entry::of(key, &[texture.channels], Target::Texels(t))
}

fn material(scene: &Scene, m: usize, users: &[Vec<&str>]) -> Vec<Entry> {
    let material = &scene.materials[m];
    let textures = material.bsdf.textures().into_iter();
    textures
        .map(|t| {
            let mut entry = texels(scene, t);
            let slot = entry.key[material.key.len()..].to_string();
            // Mitsuba puts the colour of a two-sided bsdf one level down; both spellings are taken for both kinds.
            let bare = slot.strip_prefix(".brdf_0").unwrap_or(&slot).to_string();
            let spellings = [format!(".brdf_0{bare}"), bare];
            let ids = users[m].iter().map(|id| format!("{id}.bsdf"));
            for owner in std::iter::once(material.key.clone()).chain(ids) {
                for slot in &spellings {
                    let alias = format!("{owner}{slot}");
                    if alias != entry.key && !entry.aliases.contains(&alias) {
                        entry.aliases.push(alias);
                    }
                }
            }
            entry
        })
        .collect()
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
