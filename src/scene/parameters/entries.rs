//! All keys of a scene, with what they stand for.

use super::entry::{Entry, Fixed};
use super::surfaces::Slots;
use super::target::Target;
use crate::scene::data::{Body, Lens, Normals, Scene, Sensor};

/// Every key: shape by shape with the material and light that only it has, then shared materials,
/// other textures and lights, the environment, the sensors.
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
        motions(id, Body::of(m), &mut out);
        let faces = [mesh.triangles.len(), 3];
        out.push(Entry::fixed(format!("{id}.faces"), &faces, Fixed::Faces(m)));
        let normals = format!("{id}.vertex_normals");
        let mut entry = match mesh.normals {
            Normals::Flat => None,
            Normals::Given(_) => Some(Entry::of(normals, &vertices, Target::VertexNormals(m))),
            Normals::Computed(_) => {
                let mut entry = Entry::fixed(normals, &vertices, Fixed::Normals(m));
                entry.refusal = Some("they are computed from the positions and follow these");
                Some(entry)
            }
        };
        if let Some(entry) = &mut entry {
            entry.aliases.push(format!("{id}.normals"));
        }
        out.extend(entry);
        if !mesh.uvs.is_empty() {
            let coordinates = [mesh.uvs.len(), 2];
            let key = format!("{id}.vertex_texcoords");
            let mut entry = Entry::fixed(key, &coordinates, Fixed::Uvs(m));
            entry.aliases.push(format!("{id}.texcoords"));
            out.push(entry);
        }
    }
    for instance in &scene.instances {
        motions(&instance.id, instance.body, &mut out);
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

/// How a shape moves as a whole.
fn motions(id: &str, body: Body, out: &mut Vec<Entry>) {
    for (name, count, target) in [
        ("translation", 3, Target::ShapeTranslation(body)),
        ("rotation", 3, Target::ShapeRotation(body)),
        ("scale", 1, Target::ShapeScale(body)),
    ] {
        out.push(Entry::of(format!("{id}.{name}"), &[count], target));
    }
    let to_world = Target::ShapeToWorld(body);
    out.push(Entry::of(format!("{id}.to_world"), &[4, 4], to_world));
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
    if !matches!(sensor.lens, Lens::Parallel { .. }) {
        let x_fov = format!("{id}.x_fov");
        out.push(Entry::of(x_fov, &[1], Target::SensorXFov(s)));
    }
    if let Lens::Thin {
        aperture_radius,
        focus_distance,
    } = sensor.lens
    {
        for (name, number) in [
            ("aperture_radius", aperture_radius),
            ("focus_distance", focus_distance),
        ] {
            let numbers = vec![f64::from(number)];
            out.push(Entry::numbers(format!("{id}.{name}"), &[1], numbers));
        }
    }
    let film = &sensor.film;
    let pair = |a: u32, b: u32| vec![f64::from(a), f64::from(b)];
    let fixed = [
        ("near_clip", vec![f64::from(sensor.near_clip)]),
        ("far_clip", vec![f64::from(sensor.far_clip)]),
        ("film.size", pair(film.width, film.height)),
        ("film.crop_size", film.crop_size.map(f64::from).to_vec()),
        ("film.crop_offset", film.crop_offset.map(f64::from).to_vec()),
    ];
    for (name, numbers) in fixed {
        let shape = [numbers.len()];
        out.push(Entry::numbers(format!("{id}.{name}"), &shape, numbers));
    }
    if sensor.lens == Lens::Pinhole {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let key = format!("{id}.principal_point_offset_{name}");
            let target = Target::SensorPrincipalPoint { sensor: s, axis };
            out.push(Entry::of(key, &[1], target));
        }
    }
    let to_world = Target::SensorToWorld(s);
    out.push(Entry::of(format!("{id}.to_world"), &[4, 4], to_world));
}
