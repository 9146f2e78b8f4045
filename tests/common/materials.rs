//! Other materials for the scenes of `scenes`.

use warpath::scene::{
    Bsdf, Distribution, Environment, EnvironmentMap, Layout, Material, Microfacets, Principled,
    Relief, Rgb, Scene, Texture, Wrap,
};

/// Gives the mesh `id` a material of its own, two-sided where that means anything.
pub trait Paint {
    /// A rough metal.
    fn metal(self, id: &str, alpha: f32, distribution: Distribution) -> Self;
    /// Rough glass of index 1.5.
    fn glass(self, id: &str, alpha: f32) -> Self;
    /// Rough metal whose roughness depends on the direction: texture coordinates are x and y.
    fn brushed(self, id: &str, alphas: [f32; 2], distribution: Distribution) -> Self;
    /// The same of glass.
    fn brushed_glass(self, id: &str, alphas: [f32; 2]) -> Self;
    /// Layers of every kind, of the roughness of GGX `alpha`, some of them a picture's.
    fn layers(self, id: &str, alpha: f32) -> Self;
    /// The same that let light through.
    fn clear_layers(self, id: &str, alpha: f32) -> Self;
    /// What it is made of with a map of normals, or bumps: texture coordinates are x and y.
    fn relief(self, id: &str, bumps: Option<f32>) -> Self;
    /// A thin pane of index 1.5.
    fn pane(self, id: &str) -> Self;
    /// What it is made of under a mask of this opacity.
    fn masked(self, id: &str, opacity: f32) -> Self;
    /// What it is made of, blended with a wide metal.
    fn blended(self, id: &str, weight: f32) -> Self;
    /// A smooth metal.
    fn mirror(self, id: &str) -> Self;
    /// Smooth glass of index 1.5.
    fn clear(self, id: &str) -> Self;
    /// What lets everything through.
    fn null(self, id: &str) -> Self;
    /// Coloured plastic of index 1.5, rough or smooth.
    fn plastic(self, id: &str, alpha: Option<f32>) -> Self;
    /// A diffuse surface with a picture on it: texture coordinates are x and y.
    fn picture(self, id: &str) -> Self;
    /// The same with a checkerboard.
    fn checkerboard(self, id: &str) -> Self;
    /// A diffuse mesh with a colour for each triangle.
    fn faces(self, id: &str) -> Self;
    /// All pictures without a filter: their texels meet in edges.
    fn unfiltered(self) -> Self;
    /// A mesh with a picture, whose second triangle has its own vertices and shows another place of
    /// it.
    fn torn(self, id: &str) -> Self;
    /// An environment map with a small sun, turned.
    fn sunny(self) -> Self;
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
        alpha_v: None,
    }
}

/// The same without roughness.
fn polished(mut scene: Scene) -> Scene {
    if let Some(material) = scene.materials.last_mut() {
        match &mut material.bsdf {
            Bsdf::Conductor { microfacets, .. } | Bsdf::Dielectric { microfacets, .. } => {
                *microfacets = None;
                scene.textures.pop();
            }
            _ => {}
        }
    }
    scene
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
        relief: None,
    });
    scene
}

/// Texture coordinates that are x and y.
fn mapped(mut scene: Scene, id: &str) -> Scene {
    let mesh = scene.meshes.iter_mut().find(|m| m.id == id);
    let mesh = mesh.expect("a mesh");
    mesh.uvs = mesh.positions.iter().map(|p| p.truncate()).collect();
    scene
}

fn across(scene: &mut Scene, key: &str, alphas: [f32; 2]) -> Option<Microfacets> {
    let [u, v] = alphas;
    Some(Microfacets {
        distribution: Distribution::Ggx,
        alpha: texture(scene, format!("{key}.alpha_u"), [u; 3], 1),
        alpha_v: Some(texture(scene, format!("{key}.alpha_v"), [v; 3], 1)),
    })
}

/// Every layer, with numbers of which none is at its limit.
fn principled(scene: &mut Scene, key: &str, alpha: f32, transmits: bool) -> Bsdf {
    let mut one = |name: &str, value: f32| texture(scene, format!("{key}.{name}"), [value; 3], 1);
    let p = Principled {
        base_color: 0,
        roughness: one("roughness", alpha.sqrt()),
        anisotropic: one("anisotropic", 0.4),
        metallic: one("metallic", 0.3),
        spec_trans: one("spec_trans", if transmits { 0.6 } else { 0.0 }),
        is_brushed: true,
        transmits,
        eta: one("specular", 0.6),
        by_specular: true,
        spec_tint: one("spec_tint", 0.35),
        sheen: one("sheen", 0.7),
        sheen_tint: one("sheen_tint", 0.45),
        flatness: one("flatness", 0.25),
        clearcoat: one("clearcoat", 0.8),
        clearcoat_gloss: one("clearcoat_gloss", 0.1),
    };
    let base_color = texture(scene, format!("{key}.base_color"), [0.7, 0.4, 0.2], 3);
    Bsdf::Principled(Principled { base_color, ..p })
}

/// A material over that of a mesh.
fn over(mut scene: Scene, id: &str, of: impl FnOnce(&mut Scene, usize) -> Bsdf) -> Scene {
    let mesh = scene.meshes.iter().position(|m| m.id == id);
    let mesh = mesh.expect("a mesh");
    let nested = scene.meshes[mesh].material;
    let bsdf = of(&mut scene, nested);
    scene.meshes[mesh].material = scene.materials.len();
    scene.materials.push(Material {
        key: format!("{id}.cover"),
        bsdf,
        two_sided: false,
        relief: None,
    });
    scene
}

impl Paint for Scene {
    fn brushed(self, id: &str, alphas: [f32; 2], distribution: Distribution) -> Self {
        let scene = mapped(self, id).metal(id, 0.5, distribution);
        let material = scene.materials.len() - 1;
        let mut scene = scene;
        let fine = across(&mut scene, &format!("{id}.bsdf"), alphas);
        if let Bsdf::Conductor { microfacets, .. } = &mut scene.materials[material].bsdf {
            *microfacets = fine.map(|m| Microfacets { distribution, ..m });
        }
        scene
    }

    fn brushed_glass(self, id: &str, alphas: [f32; 2]) -> Self {
        let mut scene = mapped(self, id).glass(id, 0.5);
        let material = scene.materials.len() - 1;
        let fine = across(&mut scene, &format!("{id}.bsdf"), alphas);
        if let Bsdf::Dielectric { microfacets, .. } = &mut scene.materials[material].bsdf {
            *microfacets = fine;
        }
        scene
    }

    fn layers(self, id: &str, alpha: f32) -> Self {
        paint(mapped(self, id), id, |scene, key| {
            principled(scene, key, alpha, false)
        })
    }

    fn clear_layers(self, id: &str, alpha: f32) -> Self {
        let mut scene = paint(mapped(self, id), id, |scene, key| {
            principled(scene, key, alpha, true)
        });
        if let Some(material) = scene.materials.last_mut() {
            material.two_sided = false;
        }
        scene
    }

    fn relief(self, id: &str, bumps: Option<f32>) -> Self {
        let mut scene = mapped(self, id);
        let wave = |i: u32| (i as f32 * 1.7).sin();
        let texels = (0..20).map(|i| match bumps {
            None => [0.5 + 0.15 * wave(i), 0.5 + 0.12 * wave(i + 5), 0.95],
            Some(_) => [0.5 + 0.4 * wave(i); 3],
        });
        let name = if bumps.is_some() {
            "nested_texture"
        } else {
            "normalmap"
        };
        scene.textures.push(Texture {
            texels: texels.collect(),
            layout: Layout::Bitmap {
                width: 5,
                height: 4,
                wrap: Wrap::Repeat,
                bilinear: true,
                to_uv: glam::Affine2::from_scale_angle_translation(
                    glam::vec2(0.5, 0.6),
                    0.3,
                    glam::vec2(0.1, 0.2),
                ),
            },
            channels: if bumps.is_some() { 1 } else { 3 },
            ..Texture::constant(format!("{id}.bsdf.{name}"), [0.0; 3])
        });
        let relief = Relief {
            texture: scene.textures.len() - 1,
            bumps,
            is_mirrored: true,
        };
        let mesh = scene.meshes.iter().find(|m| m.id == id).expect("a mesh");
        let material = mesh.material;
        scene.materials[material].relief = Some(relief);
        scene
    }

    fn pane(self, id: &str) -> Self {
        paint(self, id, |scene, key| Bsdf::ThinDielectric {
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
        })
    }

    fn masked(self, id: &str, opacity: f32) -> Self {
        over(self, id, |scene, nested| Bsdf::Mask {
            opacity: texture(scene, format!("{id}.bsdf.opacity"), [opacity; 3], 1),
            nested,
        })
    }

    fn blended(self, id: &str, weight: f32) -> Self {
        let first = self.meshes.iter().find(|m| m.id == id).map(|m| m.material);
        let first = first.expect("a mesh");
        let scene = self.metal(id, 0.3, Distribution::Ggx);
        over(scene, id, |scene, second| Bsdf::Blend {
            weight: texture(scene, format!("{id}.bsdf.weight"), [weight; 3], 1),
            nested: [first, second],
        })
    }

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

    fn mirror(self, id: &str) -> Self {
        polished(self.metal(id, 0.5, Distribution::Ggx))
    }

    fn clear(self, id: &str) -> Self {
        polished(self.glass(id, 0.5))
    }

    fn null(self, id: &str) -> Self {
        paint(self, id, |_, _| Bsdf::Null)
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

    fn checkerboard(mut self, id: &str) -> Self {
        let mesh = self.meshes.iter_mut().find(|m| m.id == id).expect("a mesh");
        mesh.uvs = mesh.positions.iter().map(|p| p.truncate()).collect();
        paint(self, id, |scene, key| {
            scene.textures.push(Texture {
                key: format!("{key}.brdf_0.reflectance"),
                texels: vec![[0.8, 0.7, 0.2], [0.1, 0.3, 0.5]],
                layout: Layout::Checkerboard {
                    to_uv: glam::Affine2::from_scale_angle_translation(
                        glam::vec2(1.3, 0.9),
                        0.4,
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

    fn faces(mut self, id: &str) -> Self {
        let mesh = self.meshes.iter().find(|m| m.id == id).expect("a mesh");
        let reflectance = self.materials[mesh.material].bsdf.textures()[0];
        let steps = [0.618, 0.37, 0.83];
        let colour = |i| steps.map(|step| (i as f32 * step).fract() * 0.8 + 0.1);
        self.textures[reflectance] = Texture {
            texels: (0..mesh.triangles.len()).map(colour).collect(),
            layout: Layout::Faces,
            limits: [0.0, 1.0],
            ..Texture::constant(format!("{id}.face_color"), [0.0; 3])
        };
        self
    }

    fn unfiltered(mut self) -> Self {
        for texture in &mut self.textures {
            if let Layout::Bitmap { bilinear, .. } = &mut texture.layout {
                *bilinear = false;
            }
        }
        self
    }

    fn torn(mut self, id: &str) -> Self {
        let mesh = self.meshes.iter_mut().find(|m| m.id == id).expect("a mesh");
        let first = mesh.positions.len() as u32;
        for v in mesh.triangles[1] {
            mesh.positions.push(mesh.positions[v as usize]);
            mesh.uvs.push(mesh.uvs[v as usize] + 0.4);
        }
        mesh.triangles[1] = [first, first + 1, first + 2];
        self
    }

    fn sunny(mut self) -> Self {
        let (width, height) = (32u32, 17u32);
        let mut texels = vec![[0.3, 0.4, 0.6]; (width * height) as usize];
        texels[(3 * width + 9) as usize] = [90.0, 80.0, 60.0];
        self.textures.push(Texture {
            texels,
            layout: Layout::Bitmap {
                width,
                height,
                wrap: Wrap::Repeat,
                bilinear: true,
                to_uv: glam::Affine2::IDENTITY,
            },
            ..Texture::constant("env".into(), [0.0; 3])
        });
        self.environment = Some(Environment {
            key: "env".into(),
            radiance: self.textures.len() - 1,
            map: Some(EnvironmentMap {
                to_world: glam::Mat3::from_euler(glam::EulerRot::XYZ, 1.4, 0.3, 0.1),
                scale: 1.5,
            }),
        });
        self
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
