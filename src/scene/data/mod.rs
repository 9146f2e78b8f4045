//! What a scene is once it is loaded: plain data, no file in sight.

mod light;
mod material;
mod mesh;
mod sensor;
mod texture;

pub use light::{
    AreaLight, Beam, BeamProfile, DeltaLight, DeltaLightKind, Environment, EnvironmentMap,
};
pub use material::{Bsdf, Distribution, Material, Microfacets, Principled, Relief};
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
    /// A material and all that it is made of.
    pub fn parts_of(&self, material: usize) -> Vec<usize> {
        let mut parts = vec![material];
        let mut next = 0;
        while let Some(&part) = parts.get(next) {
            parts.extend(self.materials[part].bsdf.nested().iter().map(|n| n.1));
            next += 1;
        }
        parts
    }

    /// Whether rays may go straight on through a material, as if it were not there, so that what
    /// moves behind it is seen through it.
    pub fn passes_straight_on(&self, material: usize) -> bool {
        match self.materials[material].bsdf {
            Bsdf::Null => true,
            Bsdf::Mask { opacity, .. } => self.textures[opacity].texels.iter().any(|t| t[0] < 1.0),
            _ => false,
        }
    }

    /// The textures of a material and of all that it is made of.
    pub fn textures_of(&self, material: usize) -> Vec<usize> {
        let parts = self.parts_of(material).into_iter();
        parts.flat_map(|m| self.materials[m].textures()).collect()
    }

    /// The colour of a texture that is constant (the first texel of others).
    pub fn constant(&self, texture: usize) -> Rgb {
        self.textures[texture].texels[0]
    }
}
