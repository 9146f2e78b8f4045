//! What a parameter stands for in the scene.

use crate::scene::data::{Body, Bsdf, Scene};

/// What a differentiable parameter stands for. Indices are into the vectors of [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// All vertices of a mesh, world units.
    VertexPositions(usize),
    /// The vertex normals of a mesh that are data of their own.
    VertexNormals(usize),
    /// The first three rows of what takes a shape's own space to the world, and a last one that
    /// stays (0, 0, 0, 1).
    ShapeToWorld(Body),
    /// A rigid translation of a shape, world units.
    ShapeTranslation(Body),
    /// A rotation of a shape: radians about the world axes through its bounding-box centre.
    ShapeRotation(Body),
    /// A factor on the distances from the shape's bounding-box centre; 1 at present.
    ShapeScale(Body),
    /// A translation of a sensor, world units.
    SensorTranslation(usize),
    /// A rotation of a sensor: radians about the world axes through its position.
    SensorRotation(usize),
    /// The horizontal opening angle of a sensor, degrees.
    SensorXFov(usize),
    /// The first three rows of a sensor's `to_world`; the last one stays (0, 0, 0, 1).
    SensorToWorld(usize),
    /// A coordinate of a sensor's principal point, as a fraction of the film's width or height.
    SensorPrincipalPoint { sensor: usize, axis: usize },
    /// All texels of a texture.
    Texels(usize),
    /// One texel of a texture: a colour of a checkerboard.
    Texel {
        /// Index into [`Scene::textures`].
        texture: usize,
        /// Index into its texels.
        texel: usize,
    },
    /// The two rows of the transform of a bitmap's texture coordinates.
    ToUv(usize),
    /// The factor on the environment map.
    EnvironmentScale,
    /// A rotation of the environment map: radians about the world axes.
    EnvironmentRotation,
    /// Where a point light is, world units.
    DeltaLightPosition(usize),
    /// A translation of a point light, world units.
    DeltaLightTranslation(usize),
}

impl Target {
    /// The sensor it belongs to, if it belongs to one.
    pub fn sensor(self) -> Option<usize> {
        match self {
            Target::SensorTranslation(s)
            | Target::SensorRotation(s)
            | Target::SensorXFov(s)
            | Target::SensorToWorld(s)
            | Target::SensorPrincipalPoint { sensor: s, .. } => Some(s),
            _ => None,
        }
    }

    /// Whether moving it moves what hides what.
    pub(super) fn moves_visibility(self, scene: &Scene) -> bool {
        match self {
            // What is seen through a smooth interface moves with its index of refraction.
            Target::Texels(t) => scene.materials.iter().any(|m| {
                m.relief.is_some_and(|r| r.texture == t)
                    || matches!(m.bsdf, Bsdf::Dielectric { eta, microfacets: None, .. } if eta == t)
            }),
            Target::ToUv(t) => {
                let mut reliefs = scene.materials.iter().filter_map(|m| m.relief);
                reliefs.any(|r| r.texture == t)
            }
            Target::Texel { .. } | Target::EnvironmentScale | Target::EnvironmentRotation => false,
            _ => true,
        }
    }
}
