//! The scene of the mask term: some shapes shine evenly, everything else is black.
//!
//! Its image is what these shapes cover, and through visibility it has the derivative that pulls
//! outlines to those of the masks.

use crate::optimize::config::Silhouette;
use crate::scene::{AreaLight, Bsdf, Integrator, Material, Scene, Texture};

/// What `shapes` cover, as a scene. The error says which of them there is not.
pub fn scene(scene: &Scene, silhouette: &Silhouette) -> Result<Scene, String> {
    let mut out = scene.clone();
    out.textures = vec![
        Texture::constant("black".into(), [0.0; 3]),
        Texture::constant("white".into(), [1.0; 3]),
    ];
    out.materials = vec![Material {
        key: "black".into(),
        bsdf: Bsdf::Diffuse { reflectance: 0 },
        two_sided: true,
        relief: None,
    }];
    out.area_lights = Vec::new();
    out.delta_lights = Vec::new();
    out.environment = None;
    out.integrator = Integrator {
        max_depth: 1,
        hide_emitters: false,
        ..scene.integrator
    };
    for mesh in &mut out.meshes {
        mesh.material = 0;
        mesh.area_light = None;
    }
    for id in &silhouette.shapes {
        let Some(mesh) = out.meshes.iter().position(|mesh| mesh.id == *id) else {
            let ids: Vec<&str> = out.meshes.iter().map(|mesh| mesh.id.as_str()).collect();
            return Err(format!(
                "there is no shape \"{id}\"; the scene has {}",
                ids.join(", ")
            ));
        };
        out.meshes[mesh].area_light = Some(out.area_lights.len());
        out.area_lights.push(AreaLight {
            mesh,
            radiance: 1,
            key: format!("{id}.emitter"),
        });
    }
    Ok(out)
}
