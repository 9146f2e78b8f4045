//! The materials of a scene, prepared for lookups.

use crate::paths::surface::kinds::Kinds;
use crate::paths::surface::parts::{Part, parts};
use crate::paths::surface::rough_transmission::TransmissionTable;
use crate::scene::{Bsdf, Distribution, Layout, Microfacets, Relief, Scene};

/// Slots of a material: where its numbers go in `kernels::bsdf::Interface`.
pub const REFLECTANCE: usize = 0;
pub const SECOND_REFLECTANCE: usize = 1;
pub const ETA: usize = 2;
pub const K: usize = 3;
pub const ALPHA: usize = 4;
pub const SLOTS: usize = 5;
/// Those that go to `kernels::layered::Layers`.
pub const ALPHA_V: usize = 5;
pub const ROUGHNESS: usize = 6;
pub const ANISOTROPIC: usize = 7;
pub const METALLIC: usize = 8;
pub const SPEC_TRANS: usize = 9;
pub const SPEC_TINT: usize = 10;
pub const SHEEN: usize = 11;
pub const SHEEN_TINT: usize = 12;
pub const FLATNESS: usize = 13;
pub const CLEARCOAT: usize = 14;
pub const CLEARCOAT_GLOSS: usize = 15;
pub const ALL_SLOTS: usize = 16;

/// Rough conductors and plastics this rough or rougher are also lit by light samples, and their
/// lobes differentiated in the lights' coordinates. Narrower lobes see lights along their
/// reflections alone, and are differentiated in their own (the threshold of \[Loubet2019\]'s
/// implementation, there between kernels and convolutions).
const WIDE_ALPHA: f32 = 0.15;
/// The same before an environment map: what is small on it passes through a lobe much faster than
/// the lobe changes where it stands.
const WIDE_ALPHA_BEFORE_MAPS: f32 = 0.05;

/// One material, prepared.
pub struct Entry {
    /// Slot and texture.
    pub slots: Vec<(usize, usize)>,
    /// What turns its normals.
    pub relief: Option<Relief>,
    /// Whether what is in the slot of the index of refraction is Disney's `specular`.
    pub by_specular: bool,
    pub kinds: Kinds,
    pub two_sided: bool,
    pub transmission: Option<TransmissionTable>,
}

/// All materials of a scene, prepared.
pub struct MaterialTable {
    /// By number of the material, and at the end that of what is not there.
    entries: Vec<Entry>,
    /// What each material is made of; empty for most, which are one thing.
    parts: Vec<Vec<Part>>,
    /// Whether any surface is made of several materials.
    pub any_choice: bool,
    /// Whether any is more than diffuse.
    pub any_special: bool,
    /// Whether any reflectance, index or roughness is not constant.
    pub any_texture: bool,
    /// Whether a picture turns any normals.
    pub any_relief: bool,
    /// Whether any interface is smooth: its reflections are sharp.
    pub any_smooth: bool,
    /// Whether the world is seen through any surface along a deterministic map of the ray.
    pub any_chains: bool,
}

impl MaterialTable {
    pub fn new(scene: &Scene) -> Self {
        let mut entries: Vec<Entry> = scene
            .materials
            .iter()
            .map(|m| Entry {
                two_sided: m.two_sided,
                relief: m.relief,
                ..entry(scene, &m.bsdf)
            })
            .collect();
        entries.push(entry(scene, &Bsdf::Null));
        let parts: Vec<Vec<Part>> = (0..scene.materials.len())
            .map(|m| parts(scene, m))
            .collect();
        for (material, parts) in parts.iter().enumerate() {
            let is_seen_in =
                |part: &Part| part.is_there && entries[part.entry].kinds.in_chains() != 0;
            if parts.iter().any(is_seen_in) {
                entries[material].kinds.mixed = u32::MAX;
            }
        }
        let of_mesh = |material: usize| match parts[material].as_slice() {
            [] => vec![material],
            parts => parts.iter().map(|p| p.entry).collect(),
        };
        let used = scene.meshes.iter().flat_map(|m| of_mesh(m.material));
        let used: Vec<&Entry> = used.map(|e| &entries[e]).collect();
        let used = used.into_iter();
        let textures = |e: &Entry| {
            let relief = e.relief.map(|r| (SLOTS, r.texture));
            let mut used = e.slots.iter().chain(&relief);
            used.any(|&(_, t)| scene.textures[t].layout != Layout::Constant)
        };
        Self {
            any_special: used.clone().any(|e| e.kinds.special() != 0),
            any_relief: used.clone().any(|e| e.relief.is_some()),
            any_smooth: used.clone().any(|e| e.kinds.smooth != 0),
            any_chains: used.clone().any(|e| e.kinds.in_chains() != 0),
            any_texture: used.clone().any(textures),
            any_choice: scene.meshes.iter().any(|m| !parts[m.material].is_empty()),
            parts,
            entries,
        }
    }

    /// A material that is one thing.
    pub fn entry(&self, material: usize) -> &Entry {
        &self.entries[material]
    }

    /// That of a mesh; of one that is made of several nothing that rays go through.
    pub fn of_mesh(&self, scene: &Scene, mesh: usize) -> &Entry {
        self.entry(scene.meshes[mesh].material)
    }

    /// One of the things that a material is made of; the material itself if it is one thing.
    pub fn entry_of_part(&self, material: usize, part: u16) -> &Entry {
        match self.parts[material].get(usize::from(part)) {
            Some(part) => self.entry(part.entry),
            None => self.entry(material),
        }
    }

    /// What a material is made of; empty if it is one thing.
    pub fn parts(&self, material: usize) -> &[Part] {
        &self.parts[material]
    }

    /// Whether a material, or anything it is made of, is more than diffuse.
    pub fn is_special(&self, material: usize) -> bool {
        self.any(material, |kinds| kinds.special() != 0)
    }

    /// Whether a material, or anything it is made of, is metal, glass, plastic or has layers.
    pub fn has_lobes(&self, material: usize) -> bool {
        self.any(material, |kinds| kinds.special() & !kinds.null != 0)
    }

    fn any(&self, material: usize, is: impl Fn(&Kinds) -> bool) -> bool {
        let is = |entry: usize| is(&self.entries[entry].kinds);
        is(material) || self.parts[material].iter().any(|p| is(p.entry))
    }
}

/// The least number of a texture.
fn least(scene: &Scene, texture: usize) -> f32 {
    let numbers = scene.textures[texture].texels.iter().map(|t| t[0]);
    numbers.fold(f32::INFINITY, f32::min)
}

/// Whether a roughness is wide.
fn is_wide(scene: &Scene, alpha: f32) -> bool {
    let before_map = scene.environment.as_ref().is_some_and(|e| e.map.is_some());
    let wide = if before_map {
        WIDE_ALPHA_BEFORE_MAPS
    } else {
        WIDE_ALPHA
    };
    alpha >= wide
}

// Long: one arm for every kind of material.
fn entry(scene: &Scene, bsdf: &Bsdf) -> Entry {
    const ALL: u32 = u32::MAX;
    let mut slots = Vec::new();
    let mut by_specular = false;
    let mut kinds = Kinds::default();
    let mut set = |slot: usize, texture: usize| slots.push((slot, texture));
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
        Bsdf::ThinDielectric {
            eta,
            specular_reflectance,
            specular_transmittance,
        } => {
            kinds.dielectric = ALL;
            kinds.thin = ALL;
            set(REFLECTANCE, specular_reflectance);
            set(SECOND_REFLECTANCE, specular_transmittance);
            set(ETA, eta);
            rough = Some(None);
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
        Bsdf::Principled(p) => {
            kinds.principled = ALL;
            kinds.transmits = if p.transmits { ALL } else { 0 };
            by_specular = p.by_specular;
            for (slot, texture) in [
                (REFLECTANCE, p.base_color),
                (ETA, p.eta),
                (ROUGHNESS, p.roughness),
                (ANISOTROPIC, p.anisotropic),
                (METALLIC, p.metallic),
                (SPEC_TRANS, p.spec_trans),
                (SPEC_TINT, p.spec_tint),
                (SHEEN, p.sheen),
                (SHEEN_TINT, p.sheen_tint),
                (FLATNESS, p.flatness),
                (CLEARCOAT, p.clearcoat),
                (CLEARCOAT_GLOSS, p.clearcoat_gloss),
            ] {
                set(slot, texture);
            }
            let most = scene.textures[p.anisotropic].texels.iter().map(|t| t[0]);
            let aspect = (1.0 - 0.9 * most.fold(0.0, f32::max)).sqrt();
            if is_wide(scene, least(scene, p.roughness).powi(2) * aspect) {
                kinds.wide = ALL;
            }
        }
        Bsdf::Null => kinds.null = ALL,
        // Never met: their parts are.
        Bsdf::Mask { .. } | Bsdf::Blend { .. } => {}
    }
    let mut transmission = None;
    match rough {
        None => {}
        Some(None) => kinds.smooth = ALL,
        Some(Some(Microfacets {
            distribution,
            alpha,
            alpha_v,
        })) => {
            let is_ggx = distribution == Distribution::Ggx;
            kinds.ggx = if is_ggx { ALL } else { 0 };
            set(ALPHA, alpha);
            let mut narrowest = least(scene, alpha);
            if let Some(alpha_v) = alpha_v {
                set(ALPHA_V, alpha_v);
                kinds.grained = ALL;
                narrowest = narrowest.min(least(scene, alpha_v));
            }
            if is_wide(scene, narrowest) && kinds.dielectric == 0 {
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
        by_specular,
        relief: None,
        kinds,
        two_sided: false,
        transmission,
    }
}
