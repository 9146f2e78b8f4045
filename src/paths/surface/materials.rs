//! The materials of a scene, prepared for lookups.

use crate::paths::surface::kinds::Kinds;
use crate::paths::surface::rough_transmission::TransmissionTable;
use crate::scene::{Bsdf, Distribution, Layout, Microfacets, Scene};

/// Slots of a material: where its numbers go in `kernels::bsdf::Interface`.
pub const REFLECTANCE: usize = 0;
pub const SECOND_REFLECTANCE: usize = 1;
pub const ETA: usize = 2;
pub const K: usize = 3;
pub const ALPHA: usize = 4;
pub const SLOTS: usize = 5;
/// Where a material has no texture.
pub const NONE: u32 = u32::MAX;

/// Rough conductors and plastics this rough or rougher are also lit by light samples, and their
/// lobes differentiated in the lights' coordinates. Narrower lobes see lights along their
/// reflections alone, and are differentiated in their own (the threshold of [Loubet2019]'s
/// implementation, there between kernels and convolutions).
const WIDE_ALPHA: f32 = 0.15;
/// The same before an environment map: what is small on it passes through a lobe much faster than
/// the lobe changes where it stands.
const WIDE_ALPHA_BEFORE_MAPS: f32 = 0.05;

/// One material, prepared.
pub struct Entry {
    pub slots: [u32; SLOTS],
    pub kinds: Kinds,
    pub two_sided: bool,
    pub transmission: Option<TransmissionTable>,
}

/// All materials of a scene, prepared.
pub struct MaterialTable {
    entries: Vec<Entry>,
    /// Whether any is more than diffuse.
    pub any_special: bool,
    /// Whether any reflectance, index or roughness is not constant.
    pub any_texture: bool,
    /// Whether the world is seen through any surface along a deterministic map of the ray.
    pub any_chains: bool,
}

impl MaterialTable {
    pub fn new(scene: &Scene) -> Self {
        let entries: Vec<Entry> = scene
            .materials
            .iter()
            .map(|m| Entry {
                two_sided: m.two_sided,
                ..entry(scene, &m.bsdf)
            })
            .collect();
        let used = scene.meshes.iter().map(|m| &entries[m.material]);
        let textures = |e: &Entry| {
            let used = e.slots.iter().filter(|&&t| t != NONE);
            used.clone()
                .any(|&t| scene.textures[t as usize].layout != Layout::Constant)
        };
        Self {
            any_special: used.clone().any(|e| e.kinds.special() != 0),
            any_chains: used.clone().any(|e| e.kinds.in_chains() != 0),
            any_texture: used.clone().any(textures),
            entries,
        }
    }

    /// What a mesh is made of.
    pub fn of_mesh(&self, scene: &Scene, mesh: usize) -> &Entry {
        &self.entries[scene.meshes[mesh].material]
    }
}

/// Whether a roughness is wide wherever it is looked up.
fn is_wide(scene: &Scene, alpha: usize) -> bool {
    let before_map = scene.environment.as_ref().is_some_and(|e| e.map.is_some());
    let wide = if before_map {
        WIDE_ALPHA_BEFORE_MAPS
    } else {
        WIDE_ALPHA
    };
    let least = scene.textures[alpha].texels.iter().map(|t| t[0]);
    least.fold(f32::INFINITY, f32::min) >= wide
}

fn entry(scene: &Scene, bsdf: &Bsdf) -> Entry {
    const ALL: u32 = u32::MAX;
    let mut slots = [NONE; SLOTS];
    let mut kinds = Kinds::default();
    let mut set = |slot: usize, texture: usize| slots[slot] = texture as u32;
    let mut rough = None;
    match *bsdf {
        Bsdf::Diffuse { reflectance } => set(REFLECTANCE, reflectance),
        Bsdf::Conductor {
            eta,
            k,
            specular_reflectance,
            microfacets,
        } => {
            kinds.conductor = ALL;
            set(REFLECTANCE, specular_reflectance);
            set(ETA, eta);
            set(K, k);
            rough = Some(microfacets);
        }
        Bsdf::Dielectric {
            eta,
            specular_reflectance,
            specular_transmittance,
            microfacets,
        } => {
            kinds.dielectric = ALL;
            set(REFLECTANCE, specular_reflectance);
            set(SECOND_REFLECTANCE, specular_transmittance);
            set(ETA, eta);
            rough = Some(microfacets);
        }
        Bsdf::Plastic {
            eta,
            diffuse_reflectance,
            specular_reflectance,
            nonlinear,
            microfacets,
        } => {
            kinds.plastic = ALL;
            kinds.nonlinear = if nonlinear { ALL } else { 0 };
            set(REFLECTANCE, diffuse_reflectance);
            set(SECOND_REFLECTANCE, specular_reflectance);
            set(ETA, eta);
            rough = Some(microfacets);
        }
        Bsdf::Null => kinds.null = ALL,
    }
    let mut transmission = None;
    match rough {
        None => {}
        Some(None) => kinds.smooth = ALL,
        Some(Some(Microfacets {
            distribution,
            alpha,
        })) => {
            let is_ggx = distribution == Distribution::Ggx;
            kinds.ggx = if is_ggx { ALL } else { 0 };
            set(ALPHA, alpha);
            if is_wide(scene, alpha) && kinds.dielectric == 0 {
                kinds.wide = ALL;
            }
            if let Bsdf::Plastic { eta, .. } = *bsdf {
                let (eta, alpha) = (scene.constant(eta)[0], scene.constant(alpha)[0]);
                transmission = Some(TransmissionTable::new(eta, alpha, is_ggx));
            }
        }
    }
    Entry {
        slots,
        kinds,
        two_sided: false,
        transmission,
    }
}
