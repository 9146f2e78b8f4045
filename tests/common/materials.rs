//! Other materials for the scenes of `scenes`.

use warpath::scene::{
    Bsdf, Distribution, Layout, Material, Microfacets, Rgb, Scene, Texture, Wrap,
};

/// Gives the mesh `id` a material of its own, two-sided where that means anything.
pub trait Paint {
    /// A rough metal.
    fn metal(self, id: &str, alpha: f32, distribution: Distribution) -> Self;
    /// Rough glass of index 1.5.
    fn glass(self, id: &str, alpha: f32) -> Self;
    /// Coloured plastic of index 1.5, rough or smooth.
    fn plastic(self, id: &str, alpha: Option<f32>) -> Self;
    /// A diffuse surface with a picture on it: texture coordinates are x and y.
    fn picture(self, id: &str) -> Self;
}

fn texture(scene: &mut Scene, key: String, value: Rgb, channels: usize) -> usize {
    scene.textures.push(Texture {
        channels,
        ..Texture::constant(key, value)
    });
    scene.textures.len() - 1
}

fn microfacets(
    scene: &mut Scene,
    key: &str,
    alpha: f32,
    distribution: Distribution,
) -> Microfacets {
    Microfacets {
        distribution,
        alpha: texture(scene, format!("{key}.alpha"), [alpha; 3], 1),
    }
}

fn paint(mut scene: Scene, id: &str, bsdf: impl FnOnce(&mut Scene, &str) -> Bsdf) -> Scene {
    let key = format!("{id}.bsdf");
    let bsdf = bsdf(&mut scene, &key);
    let mesh = scene
        .meshes
        .iter_mut()
        .find(|m| m.id == id)
        .expect("a mesh");
    mesh.material = scene.materials.len();
    scene.materials.push(Material {
        key,
        bsdf,
        two_sided: true,
    });
    scene
}

impl Paint for Scene {
    fn metal(self, id: &str, alpha: f32, distribution: Distribution) -> Self {
        paint(self, id, |scene, key| Bsdf::Conductor {
            eta: texture(scene, format!("{key}.eta"), [0.2, 0.9, 1.3], 3),
            k: texture(scene, format!("{key}.k"), [3.5, 2.4, 2.0], 3),
            specular_reflectance: texture(
                scene,
                format!("{key}.specular_reflectance"),
                [0.9, 0.8, 0.95],
                3,
            ),
            microfacets: Some(microfacets(scene, key, alpha, distribution)),
        })
    }

    fn glass(self, id: &str, alpha: f32) -> Self {
        paint(self, id, |scene, key| Bsdf::Dielectric {
            eta: texture(scene, format!("{key}.eta"), [1.5; 3], 1),
            specular_reflectance: texture(
                scene,
                format!("{key}.specular_reflectance"),
                [0.9; 3],
                3,
            ),
            specular_transmittance: texture(
                scene,
                format!("{key}.specular_transmittance"),
                [0.8, 0.9, 1.0],
                3,
            ),
            microfacets: Some(microfacets(scene, key, alpha, Distribution::Ggx)),
        })
    }

    fn plastic(self, id: &str, alpha: Option<f32>) -> Self {
        paint(self, id, |scene, key| Bsdf::Plastic {
            eta: texture(scene, format!("{key}.eta"), [1.5; 3], 1),
            diffuse_reflectance: texture(
                scene,
                format!("{key}.diffuse_reflectance"),
                [0.6, 0.3, 0.2],
                3,
            ),
            specular_reflectance: texture(
                scene,
                format!("{key}.specular_reflectance"),
                [0.9; 3],
                3,
            ),
            nonlinear: true,
            microfacets: alpha.map(|a| microfacets(scene, key, a, Distribution::Beckmann)),
        })
    }

    fn picture(mut self, id: &str) -> Self {
        let mesh = self.meshes.iter_mut().find(|m| m.id == id).expect("a mesh");
        mesh.uvs = mesh.positions.iter().map(|p| p.truncate()).collect();
        paint(self, id, |scene, key| {
            let texels = (0..12).map(|i| [i as f32 / 12.0, 0.3 + (i % 3) as f32 * 0.2, 0.5]);
            scene.textures.push(Texture {
                key: format!("{key}.brdf_0.reflectance"),
                texels: texels.collect(),
                layout: Layout::Bitmap {
                    width: 4,
                    height: 3,
                    wrap: Wrap::Repeat,
                    bilinear: true,
                    to_uv: glam::Affine2::from_scale_angle_translation(
                        glam::vec2(0.7, 0.9),
                        0.3,
                        glam::vec2(0.1, 0.2),
                    ),
                },
                channels: 3,
                limits: [0.0, 1.0],
            });
            Bsdf::Diffuse {
                reflectance: scene.textures.len() - 1,
            }
        })
    }
}
