//! What emits.

use glam::{Mat3, Vec3};

/// Diffuse emission of a mesh, on the side its normals point to.
#[derive(Clone, Debug)]
pub struct AreaLight {
    pub mesh: usize,
    /// Index into [`super::Scene::textures`].
    pub radiance: usize,
    pub key: String,
}

/// A light whose shadows are sharp.
#[derive(Clone, Debug)]
pub struct DeltaLight {
    pub key: String,
    pub kind: DeltaLightKind,
    /// Index into [`super::Scene::textures`]: intensity (W/sr) of a point, irradiance across the
    /// beam of a directional light.
    pub power: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeltaLightKind {
    Point {
        position: Vec3,
    },
    /// The unit direction in which the light travels.
    Directional {
        direction: Vec3,
    },
}

/// Radiance from all directions.
#[derive(Clone, Debug)]
pub struct Environment {
    pub key: String,
    /// Index into [`super::Scene::textures`]: a constant, or a latitude-longitude bitmap if there
    /// is a `map`.
    pub radiance: usize,
    pub map: Option<EnvironmentMap>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentMap {
    /// From the map's own axes (+y is up) to the world's.
    pub to_world: Mat3,
    /// Multiplies the texels.
    pub scale: f32,
}
