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
    Plastic {
        eta: usize,
        diffuse_reflectance: usize,
        specular_reflectance: usize,
        /// Colours shift with the number of internal reflections.
        nonlinear: bool,
        microfacets: Option<Microfacets>,
    },
    /// Lets everything through.
    Null,
}

/// A rough interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    pub distribution: Distribution,
    /// Roughness: a texture of one channel.
    pub alpha: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    Beckmann,
    Ggx,
}

impl Bsdf {
    /// Whether the world is seen through it along a deterministic map of the ray, at least in part.
    pub fn is_smooth(&self) -> bool {
        match self {
            Bsdf::Diffuse { .. } => false,
            Bsdf::Conductor { microfacets, .. }
            | Bsdf::Dielectric { microfacets, .. }
            | Bsdf::Plastic { microfacets, .. } => microfacets.is_none(),
            Bsdf::Null => true,
        }
    }

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
            } => Some(specular_reflectance),
            Bsdf::Plastic {
                diffuse_reflectance,
                ..
            } => Some(diffuse_reflectance),
            Bsdf::Null => None,
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
            Bsdf::Null => (Vec::new(), None),
        };
        slots.extend(microfacets.map(|m| ("alpha", m.alpha)));
        slots
    }

    /// The textures of its slots.
    pub fn textures(&self) -> Vec<usize> {
        self.slots().into_iter().map(|slot| slot.1).collect()
    }
}
