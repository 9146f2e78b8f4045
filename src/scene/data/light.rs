//! What emits.

use glam::{Mat3, Vec2, Vec3};

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
    /// beam of a directional light, what a projector shows.
    pub power: usize,
    /// How a point shines into different directions, if that differs.
    pub beam: Option<Beam>,
}

/// What a spot or a projector makes of a point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// From the world's directions to the light's own, of which z is the axis.
    pub to_local: Mat3,
    pub profile: BeamProfile,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamProfile {
    /// Full within the width of the beam, falling linearly with the angle to zero at the cutoff.
    Spot {
        beam_width_rad: f32,
        cutoff_rad: f32,
        /// A picture over the cone's square, which multiplies the power.
        texture: Option<usize>,
    },
    /// The power is a picture, which falls on the plane z = 1 between ± these tangents, as a
    /// camera's film would see it.
    Projector {
        half_tangents: Vec2,
        scale: f32,
        /// The light's z axis in the world, as long as its `to_world` makes it.
        axis: Vec3,
    },
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
