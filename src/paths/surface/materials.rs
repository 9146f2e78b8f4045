//! What each lane's surface is made of.

use crate::discontinuity::boundary::vector;
use crate::kernels::bsdf::{Interface, KindMasks, RoughTransmission};
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::rays::{from_lanes, lane_mask, lane_of};
use crate::paths::surface::rough_transmission::TransmissionTable;
use crate::paths::surface::texture::{Lookup, lookup};
use crate::scene::{Bsdf, Distribution, Layout, Microfacets, Scene};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::{Vec2, Vec3};

/// Slots of a material: where its numbers go in [`Interface`].
pub const COLOUR: usize = 0;
pub const SECOND: usize = 1;
pub const ETA: usize = 2;
pub const K: usize = 3;
pub const ALPHA: usize = 4;
const SLOTS: usize = 5;
const NONE: u32 = u32::MAX;

/// Rough conductors and plastics this rough or rougher are also lit by light samples, and their lobes differentiated in
/// the lights' coordinates. Narrower lobes see lights along their reflections alone, and are differentiated in their own
/// (the threshold of [Loubet2019]'s implementation, there between kernels and convolutions).
const WIDE_ALPHA: f32 = 0.15;

/// Where light comes from that a vertex looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// Samples of area lights and of the environment: narrow lobes see these along bounces instead.
    Sampled,
    /// Lights without an extent, which no bounce finds.
    Delta,
}

/// The kinds of a packet's surfaces, a bit a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kinds {
    pub conductor: u32,
    pub dielectric: u32,
    pub plastic: u32,
    pub null: u32,
    /// Interfaces without roughness.
    pub smooth: u32,
    pub ggx: u32,
    pub nonlinear: u32,
    /// The specular reflection is wide enough to be lit by light samples.
    pub wide: u32,
    /// Seen from the inside.
    pub inside: u32,
    /// One-sided surfaces seen from behind: they count as diffuse and black.
    pub black: u32,
}

impl Kinds {
    /// Lanes that need more than a diffuse reflectance.
    pub fn special(&self) -> u32 {
        self.conductor | self.dielectric | self.plastic | self.null
    }

    /// Lanes with a lobe too narrow for light samples: lights are seen in it along bounces alone.
    pub fn seen_along_bounces(&self) -> u32 {
        self.special() & !self.wide
    }

    /// Lanes that lights without an extent light otherwise than through [`Self::rough_glass`]: all that are not
    /// perfectly smooth.
    pub fn lit_by_delta_lights(&self) -> u32 {
        !(self.dielectric | self.null | (self.conductor & self.smooth))
    }

    /// Lanes of rough glass.
    pub fn rough_glass(&self) -> u32 {
        self.dielectric & !self.smooth
    }

    /// What of each lane `light` lights: diffuse reflection and the lobes in the second mask.
    pub fn lit_by(&self, light: LightKind) -> [u32; 2] {
        match light {
            LightKind::Sampled => [self.lit_by_samples(), self.wide],
            LightKind::Delta => [self.lit_by_delta_lights(), !self.smooth],
        }
    }

    /// Lanes that scatter diffusely, or have a lobe, so that light samples light them.
    pub fn lit_by_samples(&self) -> u32 {
        !(self.dielectric | self.null | (self.conductor & !self.wide))
    }
}

/// One material, prepared.
struct Entry {
    slots: [u32; SLOTS],
    kinds: Kinds,
    two_sided: bool,
    transmission: Option<TransmissionTable>,
}

/// All materials of a scene, prepared.
pub struct MaterialTable {
    entries: Vec<Entry>,
    /// Whether any is more than diffuse.
    pub any_special: bool,
    /// Whether any reflectance, index or roughness is not constant.
    pub any_texture: bool,
    /// Whether any interface is smooth: its reflections are sharp.
    pub any_smooth: bool,
}

/// One slot of a lane: its value and slopes.
#[derive(Clone, Copy)]
pub struct SlotLookup {
    pub slot: usize,
    pub texture: usize,
    pub lookup: Lookup,
    /// Along the barycentrics of the second and third vertex.
    pub by_barycentric: [Vec3; 2],
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
            any_smooth: used.clone().any(|e| e.kinds.smooth != 0),
            any_texture: used.clone().any(textures),
            entries,
        }
    }

    /// The kinds of the surfaces in each lane; `facing` is ±1: whether their front is seen.
    pub fn kinds(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        triangle: &[u32; LANES],
        facing: Lane,
    ) -> Kinds {
        let mut kinds = Kinds::default();
        let facing = facing.to_array();
        for lane in (0..LANES).filter(|&l| triangle[l] != NO_TRIANGLE) {
            let mesh = geometry.mesh_of_triangle[triangle[lane] as usize] as usize;
            let entry = &self.entries[scene.meshes[mesh].material];
            let is_back = facing[lane] < 0.0;
            let bit = 1 << lane;
            let transmits = (entry.kinds.dielectric | entry.kinds.null) != 0;
            if is_back && !entry.two_sided && !transmits {
                kinds.black |= bit;
                continue;
            }
            if !self.any_special {
                continue;
            }
            let k = &entry.kinds;
            kinds.conductor |= k.conductor & bit;
            kinds.dielectric |= k.dielectric & bit;
            kinds.plastic |= k.plastic & bit;
            kinds.null |= k.null & bit;
            kinds.smooth |= k.smooth & bit;
            kinds.ggx |= k.ggx & bit;
            kinds.nonlinear |= k.nonlinear & bit;
            kinds.wide |= k.wide & bit;
            if is_back && k.dielectric != 0 {
                kinds.inside |= bit;
            }
        }
        kinds
    }

    /// Calls `each` with every slot of a lane's material; `b` are the barycentrics of the second and third vertex.
    pub fn for_each_slot(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        triangle: u32,
        b: [f32; 2],
        mut each: impl FnMut(SlotLookup),
    ) {
        let mesh = geometry.mesh_of_triangle[triangle as usize] as usize;
        let entry = &self.entries[scene.meshes[mesh].material];
        for (slot, &texture) in entry.slots.iter().enumerate() {
            if texture != NONE {
                let texture = texture as usize;
                let (lookup, by_barycentric) = texture_at(scene, geometry, texture, triangle, b);
                each(SlotLookup {
                    slot,
                    texture,
                    lookup,
                    by_barycentric,
                });
            }
        }
    }

    /// What the surfaces in each lane are made of at barycentrics `b1`, `b2`; harmless numbers where there is none.
    pub fn interface(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        triangle: &[u32; LANES],
        kinds: &Kinds,
        [b1, b2]: [Lane; 2],
    ) -> Interface<Lane> {
        let mut slots = [[Vec3::ZERO; LANES]; SLOTS];
        slots[ETA] = [Vec3::splat(1.5); LANES];
        slots[ALPHA] = [Vec3::splat(0.5); LANES];
        let (b1, b2) = (b1.to_array(), b2.to_array());
        for lane in 0..LANES {
            if triangle[lane] != NO_TRIANGLE && kinds.black >> lane & 1 == 0 {
                self.for_each_slot(scene, geometry, triangle[lane], [b1[lane], b2[lane]], |s| {
                    slots[s.slot][lane] = s.lookup.value
                });
            }
        }
        interface(&slots)
    }

    /// The change of [`Self::interface`] as textures change by `change(texture, where)` and the barycentrics by `db1`, `db2`.
    #[allow(clippy::too_many_arguments)]
    pub fn interface_tangent(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        triangle: &[u32; LANES],
        kinds: &Kinds,
        [b1, b2]: [Lane; 2],
        [db1, db2]: [Lane; 2],
        change: impl Fn(usize, &Lookup) -> Vec3,
    ) -> Interface<Lane> {
        let mut slots = [[Vec3::ZERO; LANES]; SLOTS];
        let [b1, b2, db1, db2] = [b1, b2, db1, db2].map(Lane::to_array);
        for lane in 0..LANES {
            if triangle[lane] != NO_TRIANGLE && kinds.black >> lane & 1 == 0 {
                self.for_each_slot(scene, geometry, triangle[lane], [b1[lane], b2[lane]], |s| {
                    let [by_b1, by_b2] = s.by_barycentric;
                    let mixed = change(s.texture, &s.lookup);
                    slots[s.slot][lane] = mixed + by_b1 * db1[lane] + by_b2 * db2[lane];
                });
            }
        }
        interface(&slots)
    }

    /// What rough plastics let through; zeros in lanes of other kinds. The cosines are those to the ray that arrives
    /// and to the one that leaves.
    pub fn transmission(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        triangle: &[u32; LANES],
        kinds: &Kinds,
        cos_in: Lane,
        cos_out: Lane,
    ) -> RoughTransmission<Lane> {
        let rough = kinds.plastic & !kinds.smooth;
        if rough == 0 {
            return RoughTransmission::none();
        }
        let mut into = [[0.0; LANES]; 4];
        let mut out = into;
        let mut inner = [[0.0; LANES]; 3];
        let (cos_in, cos_out) = (cos_in.to_array(), cos_out.to_array());
        for lane in (0..LANES).filter(|&l| rough >> l & 1 == 1) {
            let mesh = geometry.mesh_of_triangle[triangle[lane] as usize] as usize;
            let entry = &self.entries[scene.meshes[mesh].material];
            let Some(table) = &entry.transmission else {
                continue;
            };
            let put = |rows: &mut [[f32; LANES]], values: &[f32]| {
                rows.iter_mut()
                    .zip(values)
                    .for_each(|(row, &v)| row[lane] = v);
            };
            put(&mut into, &table.at(cos_in[lane]));
            put(&mut out, &table.at(cos_out[lane]));
            put(&mut inner, &table.inner);
        }
        RoughTransmission::new(
            into.map(Lane::new),
            out.map(Lane::new),
            inner.map(Lane::new),
        )
    }
}

/// A texture at a point of a triangle, and its slopes along the barycentrics of the second and third vertex.
pub fn texture_at(
    scene: &Scene,
    geometry: &Geometry,
    texture: usize,
    triangle: u32,
    [b1, b2]: [f32; 2],
) -> (Lookup, [Vec3; 2]) {
    let texture = &scene.textures[texture];
    if texture.layout == Layout::Constant {
        return (lookup(texture, Vec2::ZERO), [Vec3::ZERO; 2]);
    }
    let [p, q, r] = geometry.triangles[triangle as usize].map(|v| geometry.uvs[v as usize]);
    let (along_1, along_2) = (q - p, r - p);
    let found = lookup(texture, p + along_1 * b1 + along_2 * b2);
    let [by_u, by_v] = found.by_uv;
    let slopes = [along_1, along_2].map(|e| by_u * e.x + by_v * e.y);
    (found, slopes)
}

fn interface(slots: &[[Vec3; LANES]; SLOTS]) -> Interface<Lane> {
    let [colour, second, eta, k, alpha] = [0, 1, 2, 3, 4].map(|s| from_lanes(&slots[s]));
    Interface {
        colour,
        second,
        eta,
        k,
        alpha: alpha.x,
    }
}

/// The slots of an interface of one lane, as [`MaterialTable::for_each_slot`] numbers them.
pub fn slot_values(s: &Interface<Lane>, lane: usize) -> [Vec3; SLOTS] {
    let alpha = V3 {
        x: s.alpha,
        y: Lane::splat(0.0),
        z: Lane::splat(0.0),
    };
    [s.colour, s.second, s.eta, s.k, alpha].map(|v| lane_of(v, lane))
}

fn entry(scene: &Scene, bsdf: &Bsdf) -> Entry {
    const ALL: u32 = u32::MAX;
    let mut slots = [NONE; SLOTS];
    let mut kinds = Kinds::default();
    let mut set = |slot: usize, texture: usize| slots[slot] = texture as u32;
    let mut rough = None;
    match *bsdf {
        Bsdf::Diffuse { reflectance } => set(COLOUR, reflectance),
        Bsdf::Conductor {
            eta,
            k,
            specular_reflectance,
            microfacets,
        } => {
            kinds.conductor = ALL;
            set(COLOUR, specular_reflectance);
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
            set(COLOUR, specular_reflectance);
            set(SECOND, specular_transmittance);
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
            set(COLOUR, diffuse_reflectance);
            set(SECOND, specular_reflectance);
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
            let least = scene.textures[alpha].texels.iter().map(|t| t[0]);
            if least.fold(f32::INFINITY, f32::min) >= WIDE_ALPHA && kinds.dielectric == 0 {
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

impl Kinds {
    /// Of packets, as the kernels take them.
    pub fn masks<F: Real<Mask = <Lane as Real>::Mask>>(&self) -> KindMasks<F> {
        self.map(lane_mask)
    }

    /// Of one lane.
    pub fn masks_of_lane<F: Real<Mask = bool>>(&self, lane: usize) -> KindMasks<F> {
        self.map(|bits| bits >> lane & 1 == 1)
    }

    fn map<F: Real>(&self, mask: impl Fn(u32) -> F::Mask) -> KindMasks<F> {
        KindMasks {
            is_conductor: mask(self.conductor),
            is_plastic: mask(self.plastic),
            is_smooth: mask(self.smooth),
            is_ggx: mask(self.ggx),
            is_nonlinear: mask(self.nonlinear),
            is_entering: mask(!self.inside),
        }
    }
}

/// One lane of an interface.
pub fn interface_of_lane(s: &Interface<Lane>, lane: usize) -> Interface<f64> {
    let of = |v: V3<Lane>| vector(lane_of(v, lane).as_dvec3());
    Interface {
        colour: of(s.colour),
        second: of(s.second),
        eta: of(s.eta),
        k: of(s.k),
        alpha: s.alpha.to_array()[lane] as f64,
    }
}
