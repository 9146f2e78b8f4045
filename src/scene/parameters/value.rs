//! What parameters are at present.

use super::entry::{Entry, Fixed};
use super::target::Target;
use super::to_uv::rows;
use super::to_world::matrix_rows;
use crate::scene::data::{DeltaLightKind, Scene, Texture};

/// What a parameter is at present.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// All its numbers.
    Numbers(Vec<f64>),
    /// The smallest and the largest of many.
    Range {
        /// The smallest.
        min: f64,
        /// The largest.
        max: f64,
    },
}

impl Value {
    /// That of a key.
    pub(super) fn of(entry: &Entry, scene: &Scene) -> Value {
        match entry.target {
            Some(Target::VertexPositions(m)) => {
                let all = scene.meshes[m].positions.iter().flat_map(|p| p.to_array());
                range(all.map(f64::from))
            }
            Some(Target::VertexNormals(m)) => normals(scene, m),
            Some(Target::ShapeToWorld(body)) => {
                Value::Numbers(matrix_rows(scene.meshes[body.first].to_world).to_vec())
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
            Some(Target::SensorToWorld(s)) => {
                let matrix = glam::Mat4::from(scene.sensors[s].to_world).transpose();
                Value::Numbers(matrix.to_cols_array().map(f64::from).to_vec())
            }
            Some(Target::SensorPrincipalPoint { sensor, axis }) => {
                let offset = scene.sensors[sensor].principal_point_offset;
                Value::Numbers(vec![f64::from(offset[axis])])
            }
            Some(Target::SensorXFov(s)) => {
                Value::Numbers(vec![f64::from(scene.sensors[s].x_fov_rad).to_degrees()])
            }
            Some(
                target @ (Target::Texels(_)
                | Target::Texel { .. }
                | Target::ToUv(_)
                | Target::EnvironmentScale
                | Target::DeltaLightPosition(_)),
            ) => of_surface(scene, target),
            None => match &entry.fixed {
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
                Fixed::Normals(m) => normals(scene, *m),
            },
        }
    }
}

fn normals(scene: &Scene, m: usize) -> Value {
    let all = scene.meshes[m].normals.vertex().unwrap_or_default();
    range(all.iter().flat_map(|n| n.to_array()).map(f64::from))
}

/// What a parameter of a texture, a delta light or the environment is now.
fn of_surface(scene: &Scene, target: Target) -> Value {
    let numbers = |texture: &Texture, texel: usize| {
        let texel = &texture.texels[texel][..texture.channels];
        Value::Numbers(texel.iter().map(|&v| f64::from(v)).collect())
    };
    match target {
        Target::Texels(t) if scene.textures[t].varies() => {
            let texture = &scene.textures[t];
            let all = texture.texels.iter();
            range(all.flat_map(|c| c[..texture.channels].iter().map(|&v| f64::from(v))))
        }
        Target::Texels(t) => numbers(&scene.textures[t], 0),
        Target::Texel { texture, texel } => numbers(&scene.textures[texture], texel),
        Target::ToUv(t) => {
            let to_uv = scene.textures[t].layout.to_uv().unwrap_or_default();
            Value::Numbers(rows(to_uv).map(f64::from).to_vec())
        }
        Target::EnvironmentScale => {
            let map = scene.environment.as_ref().and_then(|e| e.map);
            Value::Numbers(vec![map.map_or(1.0, |m| f64::from(m.scale))])
        }
        Target::DeltaLightPosition(i) => match scene.delta_lights[i].kind {
            DeltaLightKind::Point { position } => {
                Value::Numbers(position.to_array().map(f64::from).to_vec())
            }
            DeltaLightKind::Directional { .. } => Value::Numbers(Vec::new()),
        },
        _ => Value::Numbers(Vec::new()),
    }
}

fn range(values: impl Iterator<Item = f64>) -> Value {
    let (min, max) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(min, max), v| {
        (min.min(v), max.max(v))
    });
    Value::Range { min, max }
}
