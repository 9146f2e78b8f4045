//! What surfaces are made of where rays meet them.

use crate::discontinuity::boundary::vector;
use crate::kernels::bsdf::{Interface, RoughTransmission};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::kinds::Kinds;
use crate::paths::surface::materials::{ALPHA, ETA, SLOTS};
use crate::paths::surface::texture::{Lookup, lookup};
use crate::scene::{Layout, Principled, Scene};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::{Vec2, Vec3};

/// One slot of a lane: its value and slopes.
#[derive(Clone, Copy)]
pub struct SlotLookup {
    pub slot: usize,
    pub texture: usize,
    pub lookup: Lookup,
    /// Along the barycentrics of the second and third vertex.
    pub by_barycentric: [Vec3; 2],
}

impl SceneView<'_> {
    /// The kinds of the surfaces in each lane.
    pub fn kinds(&self, vertices: &Vertices) -> Kinds {
        let mut kinds = Kinds::default();
        let triangle = &vertices.triangle;
        let facing = vertices.facing.to_array();
        for lane in (0..LANES).filter(|&l| triangle[l] != NO_TRIANGLE) {
            let entry = self.entry(vertices, lane);
            let is_back = facing[lane] < 0.0;
            let bit = 1 << lane;
            let transmits =
                (entry.kinds.dielectric | entry.kinds.null | entry.kinds.transmits) != 0;
            if is_back && !entry.two_sided && !transmits {
                kinds.black |= bit;
                continue;
            }
            if entry.relief.is_some() {
                kinds.relief |= bit;
            }
            if !self.materials.any_special {
                continue;
            }
            let k = &entry.kinds;
            kinds.conductor |= k.conductor & bit;
            kinds.dielectric |= k.dielectric & bit;
            kinds.plastic |= k.plastic & bit;
            kinds.null |= k.null & bit;
            kinds.thin |= k.thin & bit;
            kinds.principled |= k.principled & bit;
            kinds.grained |= k.grained & bit;
            kinds.transmits |= k.transmits & bit;
            kinds.smooth |= k.smooth & bit;
            kinds.ggx |= k.ggx & bit;
            kinds.nonlinear |= k.nonlinear & bit;
            kinds.wide |= k.wide & bit;
            if is_back && (k.dielectric & !k.thin | k.transmits) != 0 {
                kinds.inside |= bit;
            }
        }
        kinds
    }

    /// Calls `each` with every slot of a lane's material; `b` are the barycentrics of the second
    /// and third vertex.
    pub fn for_each_slot(
        &self,
        vertices: &Vertices,
        lane: usize,
        b: [f32; 2],
        mut each: impl FnMut(SlotLookup),
    ) {
        let triangle = vertices.triangle[lane];
        let entry = self.entry(vertices, lane);
        for &(slot, texture) in &entry.slots {
            let (mut lookup, by_barycentric) =
                texture_at(self.scene, self.geometry, texture, triangle, b);
            if slot == ETA && entry.by_specular {
                // It is constant: its one weight is what it moves the index by.
                let [eta, slope] = Principled::eta_of_specular(lookup.value.x);
                lookup.value = Vec3::splat(eta);
                lookup.weights[0] = slope;
            }
            each(SlotLookup {
                slot,
                texture,
                lookup,
                by_barycentric,
            });
        }
    }

    /// What the surfaces in each lane are made of at barycentrics `b1`, `b2`; harmless numbers
    /// where there is none.
    pub fn interface(&self, vertices: &Vertices, [b1, b2]: [Lane; 2]) -> Interface<Lane> {
        let Vertices {
            triangle, kinds, ..
        } = vertices;
        let mut slots = [[Vec3::ZERO; LANES]; SLOTS];
        slots[ETA] = [Vec3::splat(1.5); LANES];
        slots[ALPHA] = [Vec3::splat(0.5); LANES];
        let (b1, b2) = (b1.to_array(), b2.to_array());
        for lane in 0..LANES {
            if triangle[lane] != NO_TRIANGLE && kinds.black >> lane & 1 == 0 {
                self.for_each_slot(vertices, lane, [b1[lane], b2[lane]], |s| {
                    if s.slot < SLOTS {
                        slots[s.slot][lane] = s.lookup.value;
                    }
                });
            }
        }
        interface(&slots)
    }

    /// The change of [`Self::interface`] as textures change by `change(texture, where)` and the
    /// barycentrics by `db1`, `db2`.
    pub fn interface_change(
        &self,
        vertices: &Vertices,
        [b1, b2]: [Lane; 2],
        [db1, db2]: [Lane; 2],
        change: impl Fn(usize, &Lookup) -> Vec3,
    ) -> Interface<Lane> {
        let Vertices {
            triangle, kinds, ..
        } = vertices;
        let mut slots = [[Vec3::ZERO; LANES]; SLOTS];
        let [b1, b2, db1, db2] = [b1, b2, db1, db2].map(Lane::to_array);
        for lane in 0..LANES {
            if triangle[lane] != NO_TRIANGLE && kinds.black >> lane & 1 == 0 {
                self.for_each_slot(vertices, lane, [b1[lane], b2[lane]], |s| {
                    if s.slot < SLOTS {
                        let [by_b1, by_b2] = s.by_barycentric;
                        let mixed = change(s.texture, &s.lookup);
                        slots[s.slot][lane] = mixed + by_b1 * db1[lane] + by_b2 * db2[lane];
                    }
                });
            }
        }
        interface(&slots)
    }

    /// What rough plastics let through on the way to directions at cosine `cos_out` to the normal
    /// `n`; zeros in lanes of other kinds.
    pub fn transmission(
        &self,
        vertices: &Vertices,
        n: V3<Lane>,
        cos_out: Lane,
    ) -> RoughTransmission<Lane> {
        let kinds = &vertices.kinds;
        let rough = kinds.plastic & !kinds.smooth;
        if rough == 0 {
            return RoughTransmission::none();
        }
        let cos_in = -(vertices.direction.normalize().dot(n));
        let mut into = [[0.0; LANES]; 4];
        let mut out = into;
        let mut inner = [[0.0; LANES]; 3];
        let (cos_in, cos_out) = (cos_in.to_array(), cos_out.to_array());
        for lane in (0..LANES).filter(|&l| rough >> l & 1 == 1) {
            let Some(table) = &self.entry(vertices, lane).transmission else {
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

/// A texture at a point of a triangle, and its slopes along the barycentrics of the second and
/// third vertex.
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
    let mesh = geometry.mesh_of_triangle[triangle as usize] as usize;
    if texture.layout == Layout::Faces {
        let texel = triangle - geometry.first_triangle[mesh];
        return (Lookup::of_one(texture, texel), [Vec3::ZERO; 2]);
    }
    if texture.layout == Layout::Vertices {
        let first = geometry.first_vertex[mesh];
        let [a, b, c] = geometry.triangles[triangle as usize].map(|v| v - first);
        let [p, q, r] = [a, b, c].map(|t| Vec3::from(texture.texels[t as usize]));
        let found = Lookup {
            value: p + (q - p) * b1 + (r - p) * b2,
            texels: [a, b, c, a],
            weights: [1.0 - b1 - b2, b1, b2, 0.0],
            by_uv: [Vec3::ZERO; 2],
            by_place: [Vec3::ZERO; 2],
            uv: Vec2::ZERO,
        };
        return (found, [q - p, r - p]);
    }
    let [p, q, r] = geometry.triangles[triangle as usize].map(|v| geometry.uvs[v as usize]);
    let (along_1, along_2) = (q - p, r - p);
    let found = lookup(texture, p + along_1 * b1 + along_2 * b2);
    let [by_u, by_v] = found.by_uv;
    let slopes = [along_1, along_2].map(|e| by_u * e.x + by_v * e.y);
    (found, slopes)
}

fn interface(slots: &[[Vec3; LANES]; SLOTS]) -> Interface<Lane> {
    let [reflectance, second_reflectance, eta, k, alpha] =
        [0, 1, 2, 3, 4].map(|s| from_lanes(&slots[s]));
    Interface {
        reflectance,
        second_reflectance,
        eta,
        k,
        alpha: alpha.x,
    }
}

/// The slots of an interface of one lane, as [`SceneView::for_each_slot`] numbers them.
pub fn slot_values(s: &Interface<Lane>, lane: usize) -> [Vec3; SLOTS] {
    let alpha = V3 {
        x: s.alpha,
        y: Lane::splat(0.0),
        z: Lane::splat(0.0),
    };
    [s.reflectance, s.second_reflectance, s.eta, s.k, alpha].map(|v| lane_of(v, lane))
}

/// One lane of an interface.
pub fn interface_of_lane(s: &Interface<Lane>, lane: usize) -> Interface<f64> {
    let of = |v: V3<Lane>| vector(lane_of(v, lane).as_dvec3());
    Interface {
        reflectance: of(s.reflectance),
        second_reflectance: of(s.second_reflectance),
        eta: of(s.eta),
        k: of(s.k),
        alpha: s.alpha.to_array()[lane] as f64,
    }
}
