//! What a scene is once it is loaded: plain data, no file in sight.

mod light;
mod material;
mod mesh;
mod sensor;
mod texture;

pub use light::{
    AreaLight, Beam, BeamProfile, DeltaLight, DeltaLightKind, Environment, EnvironmentMap,
};
pub use material::{Bsdf, Distribution, Material, Microfacets};
pub use mesh::{Body, Mesh, Normals};
pub use sensor::{Film, Filter, Lens, Sensor};
pub use texture::{Layout, Rgb, Texture, Wrap};

/// A loaded scene. Indices (`material`, `emitter`) point into its own vectors.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shapes in the order of the file.
    pub meshes: Vec<Mesh>,
    /// Instances of several shapes, which move as one.
    pub instances: Vec<Instance>,
    pub materials: Vec<Material>,
    /// Everything that has a colour: slots of materials and emitters point here.
    pub textures: Vec<Texture>,
    /// Area emitters, in the order of their shapes.
    pub area_lights: Vec<AreaLight>,
    /// Delta lights, in the order of the file.
    pub delta_lights: Vec<DeltaLight>,
    /// The `constant` or `envmap` environment, if the scene has one.
    pub environment: Option<Environment>,
    /// At least one.
    pub sensors: Vec<Sensor>,
    pub integrator: Integrator,
    /// Non-fatal remarks met while loading (unread properties, dropped zero-area faces, …).
    pub warnings: Vec<String>,
    /// FNV-1a 64 of every file read, after substitution, in reading order.
    pub hash: u64,
}

/// An instance of a group of several shapes. One of a single shape is nothing but a mesh.
#[derive(Clone, Debug)]
pub struct Instance {
    pub id: String,
    pub body: Body,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator {
    /// Longest path in segments; `u32::MAX` for Mitsuba's −1.
    pub max_depth: u32,
    /// First segment at which russian roulette may end a path.
    pub rr_depth: u32,
    /// Emitters seen directly by the camera are black.
    pub hide_emitters: bool,
}

impl Scene {
    /// The colour of a texture that is constant (the first texel of others).
    pub fn constant(&self, texture: usize) -> Rgb {
        self.textures[texture].texels[0]
    }
}
