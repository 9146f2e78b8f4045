//! What surfaces do with light.

/// How a surface reflects and transmits. Only what a scene here needs.
#[derive(Clone, Debug)]
pub struct Material {
    /// The key under which `params` lists it (`<id>` or `<shape id>.bsdf`).
    pub key: String,
    pub bsdf: Bsdf,
    /// Reflects on both sides (`twosided`); otherwise the back is black. Means nothing to those
    /// that transmit.
    pub two_sided: bool,
    /// What turns its normals (`normalmap`, `bumpmap`).
    pub relief: Option<Relief>,
}

/// A picture that turns normals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relief {
    pub texture: usize,
    /// The heights of bumps are the picture's times this, in world units; else it is a map of
    /// normals, of three channels.
    pub bumps: Option<f32>,
    /// It stands inside a `twosided`, so that the back is a mirror image of the front; otherwise it
    /// is the same relief seen from the other side.
    pub is_mirrored: bool,
}

impl Material {
    /// The slots that hold a texture, under Mitsuba's names.
    pub fn slots(&self) -> Vec<(&'static str, usize)> {
        let mut slots = self.bsdf.slots();
        slots.extend(self.relief.map(|relief| {
            let name = if relief.bumps.is_some() {
                "nested_texture"
            } else {
                "normalmap"
            };
            (name, relief.texture)
        }));
        slots
    }

    /// The textures of its slots.
    pub fn textures(&self) -> Vec<usize> {
        self.slots().into_iter().map(|slot| slot.1).collect()
    }
}

/// Plugins of Mitsuba 3, with its conventions. Colours and roughnesses are indices into
/// [`super::Scene::textures`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    Diffuse {
        reflectance: usize,
    },
    Conductor {
        /// Real and imaginary index of refraction, in RGB. A mirror of reflectance 1 has η = 0, k =
        /// 1.
        eta: usize,
        k: usize,
        specular_reflectance: usize,
        microfacets: Option<Microfacets>,
    },
    Dielectric {
        /// Index inside over index outside (a texture of one channel).
        eta: usize,
        specular_reflectance: usize,
        specular_transmittance: usize,
        microfacets: Option<Microfacets>,
    },
    /// A pane so thin that light goes straight on through it.
    ThinDielectric {
        /// As of dielectrics.
        eta: usize,
        specular_reflectance: usize,
        specular_transmittance: usize,
    },
    Plastic {
        eta: usize,
        diffuse_reflectance: usize,
        specular_reflectance: usize,
        /// Colours shift with the number of internal reflections.
        nonlinear: bool,
        microfacets: Option<Microfacets>,
    },
    /// Many layers.
    Principled(Principled),
    /// Lets everything through.
    Null,
    /// Is met where `opacity` says (a texture of one channel), and otherwise lets all through.
    Mask {
        opacity: usize,
        /// What is met, as an index into [`super::Scene::materials`].
        nested: usize,
    },
    /// Two materials mixed.
    Blend {
        /// The part of the second one: a texture of one channel.
        weight: usize,
        /// Indices into [`super::Scene::materials`].
        nested: [usize; 2],
    },
}

/// Burley's layers: textures, all but the first of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Principled {
    pub base_color: usize,
    pub roughness: usize,
    pub anisotropic: usize,
    pub metallic: usize,
    pub spec_trans: usize,
    /// Whether it has a grain, along which the roughness is another than across.
    pub is_brushed: bool,
    /// Whether it lets any light through.
    pub transmits: bool,
    /// Index inside over index outside, or what stands for it.
    pub eta: usize,
    /// Whether that is Disney's `specular`.
    pub by_specular: bool,
    pub spec_tint: usize,
    pub sheen: usize,
    pub sheen_tint: usize,
    pub flatness: usize,
    pub clearcoat: usize,
    pub clearcoat_gloss: usize,
}

impl Principled {
    /// The index of refraction of a `specular` of `s`, and its slope.
    pub fn eta_of_specular(s: f32) -> [f32; 2] {
        let root = (0.08 * f64::from(s)).sqrt();
        let eta = 2.0 / (1.0 - root) - 1.0;
        let slope = 0.08 / (root.max(1e-6) * (1.0 - root) * (1.0 - root));
        [eta as f32, slope as f32]
    }

    fn slots(&self) -> Vec<(&'static str, usize)> {
        let eta = if self.by_specular { "specular" } else { "eta" };
        vec![
            ("base_color", self.base_color),
            ("roughness", self.roughness),
            ("anisotropic", self.anisotropic),
            ("metallic", self.metallic),
            ("spec_trans", self.spec_trans),
            (eta, self.eta),
            ("spec_tint", self.spec_tint),
            ("sheen", self.sheen),
            ("sheen_tint", self.sheen_tint),
            ("flatness", self.flatness),
            ("clearcoat", self.clearcoat),
            ("clearcoat_gloss", self.clearcoat_gloss),
        ]
    }
}

/// A rough interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    pub distribution: Distribution,
    /// Roughness: a texture of one channel.
    pub alpha: usize,
    /// Roughness along v, if it is not the same in all directions; the other is along u then.
    pub alpha_v: Option<usize>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    Beckmann,
    Ggx,
}

impl Bsdf {
    /// The texture of its main colour.
    pub fn colour(&self) -> Option<usize> {
        match *self {
            Bsdf::Diffuse { reflectance } => Some(reflectance),
            Bsdf::Conductor {
                specular_reflectance,
                ..
            }
            | Bsdf::Dielectric {
                specular_reflectance,
                ..
            }
            | Bsdf::ThinDielectric {
                specular_reflectance,
                ..
            } => Some(specular_reflectance),
            Bsdf::Plastic {
                diffuse_reflectance,
                ..
            } => Some(diffuse_reflectance),
            Bsdf::Principled(Principled { base_color, .. }) => Some(base_color),
            Bsdf::Null | Bsdf::Mask { .. } | Bsdf::Blend { .. } => None,
        }
    }

    /// The slots that hold a texture, under Mitsuba's names.
    pub fn slots(&self) -> Vec<(&'static str, usize)> {
        let (mut slots, microfacets) = match *self {
            Bsdf::Diffuse { reflectance } => (vec![("reflectance", reflectance)], None),
            Bsdf::Conductor {
                eta,
                k,
                specular_reflectance,
                microfacets,
            } => (
                vec![
                    ("eta", eta),
                    ("k", k),
                    ("specular_reflectance", specular_reflectance),
                ],
                microfacets,
            ),
            Bsdf::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
                microfacets,
            } => (
                vec![
                    ("eta", eta),
                    ("specular_reflectance", specular_reflectance),
                    ("specular_transmittance", specular_transmittance),
                ],
                microfacets,
            ),
            Bsdf::ThinDielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
            } => (
                vec![
                    ("eta", eta),
                    ("specular_reflectance", specular_reflectance),
                    ("specular_transmittance", specular_transmittance),
                ],
                None,
            ),
            Bsdf::Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                microfacets,
                ..
            } => (
                vec![
                    ("eta", eta),
                    ("diffuse_reflectance", diffuse_reflectance),
                    ("specular_reflectance", specular_reflectance),
                ],
                microfacets,
            ),
            Bsdf::Principled(principled) => (principled.slots(), None),
            Bsdf::Null => (Vec::new(), None),
            Bsdf::Mask { opacity, .. } => (vec![("opacity", opacity)], None),
            Bsdf::Blend { weight, .. } => (vec![("weight", weight)], None),
        };
        if let Some(Microfacets { alpha, alpha_v, .. }) = microfacets {
            match alpha_v {
                None => slots.push(("alpha", alpha)),
                Some(alpha_v) => slots.extend([("alpha_u", alpha), ("alpha_v", alpha_v)]),
            }
        }
        slots
    }

    /// The materials that it is made of, with what Mitsuba calls them.
    pub fn nested(&self) -> Vec<(&'static str, usize)> {
        match *self {
            Bsdf::Mask { nested, .. } => vec![("nested_bsdf", nested)],
            Bsdf::Blend { nested: [a, b], .. } => vec![("bsdf_0", a), ("bsdf_1", b)],
            _ => Vec::new(),
        }
    }

    /// Whether its roughness depends on the direction.
    pub fn has_grain(&self) -> bool {
        match *self {
            Bsdf::Principled(p) => p.is_brushed,
            Bsdf::Conductor { microfacets, .. } | Bsdf::Dielectric { microfacets, .. } => {
                microfacets.is_some_and(|m| m.alpha_v.is_some())
            }
            _ => false,
        }
    }

    /// The textures of parts of a whole: what is there of which at zero and at one changes kind.
    pub fn fractions(&self) -> Vec<usize> {
        match *self {
            Bsdf::Mask { opacity, .. } => vec![opacity],
            Bsdf::Blend { weight, .. } => vec![weight],
            Bsdf::Principled(p) => vec![p.metallic, p.spec_trans],
            _ => Vec::new(),
        }
    }

    /// The textures of its slots.
    pub fn textures(&self) -> Vec<usize> {
        self.slots().into_iter().map(|slot| slot.1).collect()
    }
}
