//! Layers and grain where rays meet surfaces (`kernels::layered`).

use crate::kernels::layered::Layers;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::lane_of;
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::materials::{ALL_SLOTS, SLOTS};
use crate::paths::surface::texture::Lookup;
use crate::trace::geometry::NO_TRIANGLE;
use glam::Vec3;

/// Numbers of [`Layers`], in the order of their slots.
const NUMBERS: usize = ALL_SLOTS - SLOTS;
/// Of lanes that have none: harmless.
const NEUTRAL: [f32; NUMBERS] = [0.5, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

impl SceneView<'_> {
    /// Layers and grain in each lane at barycentrics `b` of the second and third vertex, if any has
    /// some; `tangent` is the direction of the grain.
    pub fn layers(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        tangent: V3<Lane>,
    ) -> Option<Layers<Lane>> {
        let lanes = vertices.kinds.layered();
        if lanes == 0 {
            return None;
        }
        let b = b.map(Lane::to_array);
        let mut numbers = NEUTRAL.map(|number| [number; LANES]);
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            self.for_each_slot(vertices, lane, [b[0][lane], b[1][lane]], |s| {
                if s.slot >= SLOTS {
                    numbers[s.slot - SLOTS][lane] = s.lookup.value.x;
                }
            });
        }
        Some(of_numbers(tangent, numbers.map(Lane::new)))
    }

    /// The change of [`Self::layers`], as `interface_change` has it; the tangent is as given.
    pub fn layers_change(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        db: [Lane; 2],
        tangent: V3<Lane>,
        change: impl Fn(usize, &Lookup) -> Vec3,
    ) -> Layers<Lane> {
        let lanes = vertices.kinds.layered();
        let (b, db) = (b.map(Lane::to_array), db.map(Lane::to_array));
        let mut numbers = [[0.0; LANES]; NUMBERS];
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            self.for_each_slot(vertices, lane, [b[0][lane], b[1][lane]], |s| {
                if s.slot >= SLOTS {
                    let [by_b1, by_b2] = s.by_barycentric;
                    let mixed = change(s.texture, &s.lookup);
                    let moved = by_b1 * db[0][lane] + by_b2 * db[1][lane];
                    numbers[s.slot - SLOTS][lane] = mixed.x + moved.x;
                }
            });
        }
        of_numbers(tangent, numbers.map(Lane::new))
    }

    /// How the direction in which the first texture coordinate grows is made of the edges from the
    /// first vertex to the second and the third, in each lane. Without texture coordinates it is
    /// the first of them, as in Mitsuba.
    pub fn grain(&self, triangle: &[u32; LANES]) -> [Lane; 2] {
        let mut parts = [[1.0; LANES], [0.0; LANES]];
        for lane in (0..LANES).filter(|&l| triangle[l] != NO_TRIANGLE) {
            let [along_1, along_2] = self.grain_of(triangle[lane]);
            (parts[0][lane], parts[1][lane]) = (along_1, along_2);
        }
        parts.map(Lane::new)
    }

    fn grain_of(&self, triangle: u32) -> [f32; 2] {
        let geometry = self.geometry;
        let mesh = geometry.mesh_of_triangle[triangle as usize] as usize;
        if self.scene.meshes[mesh].uvs.is_empty() {
            return [1.0, 0.0];
        }
        let [p, q, r] = geometry.triangles[triangle as usize].map(|v| geometry.uvs[v as usize]);
        let (along_1, along_2) = (q - p, r - p);
        let area = along_1.perp_dot(along_2);
        if area == 0.0 {
            return [1.0, 0.0];
        }
        // The length of the tangent does not matter, its side does.
        let size = area.signum() / along_1.abs().max(along_2.abs()).max_element();
        [along_2.y * size, -along_1.y * size]
    }
}

/// The direction of the grain, from the corners and what [`SceneView::grain`] says.
pub fn tangent<F: crate::lanes::Real>([v0, v1, v2]: [V3<F>; 3], [a, b]: [F; 2]) -> V3<F> {
    (v1 - v0) * a + (v2 - v0) * b
}

/// From the tangent and the numbers in the order of their slots.
pub fn of_numbers<F>(tangent: V3<F>, numbers: [F; NUMBERS]) -> Layers<F> {
    let [
        alpha_v,
        roughness,
        anisotropic,
        metallic,
        spec_trans,
        spec_tint,
        sheen,
        sheen_tint,
        flatness,
        clearcoat,
        clearcoat_gloss,
    ] = numbers;
    Layers {
        tangent,
        alpha_v,
        roughness,
        anisotropic,
        metallic,
        spec_trans,
        spec_tint,
        sheen,
        sheen_tint,
        flatness,
        clearcoat,
        clearcoat_gloss,
    }
}

/// The numbers, in the order of their slots.
pub fn numbers<F: Copy>(l: &Layers<F>) -> [F; NUMBERS] {
    [
        l.alpha_v,
        l.roughness,
        l.anisotropic,
        l.metallic,
        l.spec_trans,
        l.spec_tint,
        l.sheen,
        l.sheen_tint,
        l.flatness,
        l.clearcoat,
        l.clearcoat_gloss,
    ]
}

/// One lane, in f64.
pub fn layers_of_lane(l: &Layers<Lane>, lane: usize) -> Layers<f64> {
    let tangent = crate::discontinuity::boundary::vector(lane_of(l.tangent, lane).as_dvec3());
    of_numbers(tangent, numbers(l).map(|n| f64::from(n.to_array()[lane])))
}
