//! What of a scene has changed, and so what of its parts must be made anew.

use crate::scene::Scene;
use crate::scene::parameters::Target;

/// What of a scene is no longer as it was when its [`Parts`] were made.
#[derive(Clone, Debug, PartialEq)]
pub struct Edits {
    /// Per mesh: whether its vertices or normals have moved.
    pub moved: Vec<bool>,
    /// Per texture: whether any of its numbers has changed.
    pub textures: Vec<bool>,
    /// Whether the environment map has turned, or its scale has changed.
    pub environment: bool,
}

impl Edits {
    /// None yet.
    pub fn none(scene: &Scene) -> Self {
        Self {
            moved: vec![false; scene.meshes.len()],
            textures: vec![false; scene.textures.len()],
            environment: false,
        }
    }

    /// Notes that the numbers behind `target` have changed.
    pub fn mark(&mut self, target: Target) {
        match target {
            Target::VertexPositions(mesh) | Target::VertexNormals(mesh) => self.moved[mesh] = true,
            Target::ShapeTranslation(body)
            | Target::ShapeToWorld(body)
            | Target::ShapeRotation(body)
            | Target::ShapeScale(body) => self.moved[body.meshes()].fill(true),
            Target::Texels(texture) | Target::Texel { texture, .. } | Target::ToUv(texture) => {
                self.textures[texture] = true
            }
            Target::EnvironmentScale | Target::EnvironmentRotation => self.environment = true,
            // Cameras and delta lights are read from the scene itself.
            Target::SensorTranslation(_)
            | Target::SensorRotation(_)
            | Target::SensorXFov(_)
            | Target::SensorToWorld(_)
            | Target::SensorPrincipalPoint { .. }
            | Target::DeltaLightPosition(_)
            | Target::DeltaLightTranslation(_) => {}
        }
    }

    /// Whether lights have changed.
    pub fn lights(&self, scene: &Scene) -> bool {
        let mut radiances = scene.area_lights.iter().map(|light| light.radiance);
        self.moved.contains(&true) || radiances.any(|texture| self.textures[texture])
    }

    /// A table of materials keeps nothing of their colours.
    pub fn materials(&self, scene: &Scene) -> bool {
        let slots = scene.materials.iter().flat_map(|m| m.bsdf.slots());
        let mut kept = slots.filter(|(name, _)| {
            matches!(
                *name,
                "alpha" | "alpha_u" | "alpha_v" | "eta" | "roughness" | "anisotropic"
            )
        });
        kept.any(|(_, texture)| self.textures[texture])
    }

    /// Whether the environment has changed.
    pub fn environment_changes(&self, scene: &Scene) -> bool {
        let radiance = scene.environment.as_ref().map(|e| e.radiance);
        self.environment || radiance.is_some_and(|texture| self.textures[texture])
    }
}
