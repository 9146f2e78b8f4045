//! Light samples: what area lights bring to a vertex.
//!
//! At every vertex the light that arrives from area lights is an integral over the lights' own
//! surface (`kernels::light`), estimated by light samples and by bounces that happen to end on a
//! light, combined by the power heuristic. The weights and densities are numbers at θ₀: they are
//! ways of *sampling* an integrand that is differentiated in coordinates which no strategy depends
//! on, so freezing them is exact (docs/method.md warns of freezing them where strategies move
//! differently). Narrow lobes do not take part: see `paths::surface::materials`.

use crate::kernels::light::triangle_irradiance;
use crate::kernels::normal::face_normal;
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{LANES, Lane, Mask, Real, V3};
use crate::paths::at::At;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Pair;
use crate::paths::estimator::LightDraw;
use crate::paths::rays::{from_lanes, lane_mask, masked, splat};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{LightSamples, Vertices};
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::vertex::Surface;
use crate::scene::{Layout, Rgb};
use crate::trace::geometry::gather;
use glam::Vec3;

impl SceneView<'_> {
    /// For emission found by a bounce that left `from`: the MIS weight against the light samples of
    /// that vertex, times what turns its irradiance into the radiance of the path; and π times the
    /// BSDF times the irradiance.
    pub fn sampled_emission(
        &self,
        vertices: &Vertices,
        from: &Vertices,
        surface: &Surface,
    ) -> (Lane, V3<Lane>) {
        let corners = self.geometry.corners(&vertices.triangle);
        let v = self.geometry.gather_positions(&corners);
        let d = vertices.direction;
        let (t, b1, b2) = triangle_hit(vertices.origin, d, v[0], v[1], v[2]);
        let cos_light = -(d.dot(face_normal(v[0], v[1], v[2])));
        let cos = surface.n.dot(d);
        let pdf_area = self.per_lane(&vertices.triangle, |mesh, _| {
            [self.lights.of_mesh[mesh].map_or(0.0, |l| self.lights.pdf_area[l as usize]); 3]
        });
        let over_cos = self.bsdf_pdf_over_cos(from, surface, d);
        // Both densities over solid angle, times cos_light: against p_A·r²/cos_light.
        let bounce = cos * cos_light * over_cos;
        let light = pdf_area.x * t * t;
        let weight = bounce * bounce / (bounce * bounce + light * light);
        let irradiance = triangle_irradiance(surface.x, surface.n, v, b1, b2);
        let scale = Lane::splat(std::f32::consts::FRAC_1_PI) / (over_cos * irradiance);
        let zero = Lane::splat(0.0);
        let emits = lane_mask(vertices.hit)
            & light.gt(zero)
            & cos_light.gt(zero)
            & over_cos.gt(zero)
            & irradiance.gt(zero);
        let weight = <Lane as Real>::select(emits, weight * scale * from.survival, zero);
        let value = self.bsdf_evaluate(from, surface, d, LightKind::Sampled) * irradiance;
        (weight, masked(emits.to_bits(), value))
    }
}

impl At<'_> {
    /// Draws a light sample in every lane; `with_bounce`: bounces may find the light, too.
    pub fn sample_light(
        &self,
        with_bounce: bool,
        counts: &mut Counts,
    ) -> (LightSamples, LightDraw) {
        let Self {
            view,
            vertices,
            surface,
            ..
        } = *self;
        let drawn = self.draw_light();
        let DrawnLight {
            draw: LightDraw { patch, square },
            at: [s, r],
            pdf,
        } = drawn;
        let irradiance = view.patch_irradiance(surface, &patch, &s, &r);
        let zero = Lane::splat(0.0);
        let lit = irradiance.gt(zero) & lane_mask(vertices.hit & vertices.kinds.lit_by_samples());
        let y = view.patch_points(&patch, &s, &r);
        let rays = view.toward(surface.x, surface.geometric, y, lit.to_bits());
        let visible = view.unoccluded(&rays, &mut counts.shadow);
        let mut weight = Lane::splat(1.0) / Lane::new(pdf);
        let w = y - surface.x;
        if with_bounce {
            // In (s, r) the bounce's density is p/cos·π times the irradiance kernel; p/cos is 1/π
            // for diffuse light.
            let over_cos = view.bsdf_pdf_over_cos(vertices, surface, w.normalize());
            let bounce = irradiance * over_cos * Lane::splat(std::f32::consts::PI);
            let light = Lane::new(pdf);
            weight *= light * light / (light * light + bounce * bounce);
        }
        let light = LightSamples {
            patch,
            s: Lane::new(s),
            r: Lane::new(r),
            weight: <Lane as Real>::select(lane_mask(visible), weight, zero),
            irradiance: <Lane as Real>::select(lit, irradiance, zero),
            value: masked(
                lit.to_bits(),
                view.bsdf_evaluate(vertices, surface, w, LightKind::Sampled),
            ),
        };
        (light, LightDraw { patch, square })
    }
}

/// A point of a light in each lane.
struct DrawnLight {
    draw: LightDraw,
    /// In the patch.
    at: [[f32; LANES]; 2],
    /// Over the patch's square, or triangle.
    pdf: [f32; LANES],
}

impl At<'_> {
    fn draw_light(&self) -> DrawnLight {
        let view = self.view;
        let (s, r) = self.numbers.pair(Pair::LightPoint);
        let (pick, _) = if view.lights.patches.len() > 1 {
            self.numbers.pair(Pair::LightPatch)
        } else {
            (Lane::splat(0.0), Lane::splat(0.0))
        };
        let (patch, _) = view.lights.pick(pick);
        let patches = patch.map(|p| &view.lights.patches[p as usize]);
        // Fold the square onto a single triangle, on which the density doubles.
        let square = [s.to_array(), r.to_array()];
        let [mut s, mut r] = square;
        let mut pdf = [0.0; LANES];
        for l in 0..LANES {
            pdf[l] = patches[l].probability;
            if patches[l].upper.is_none() {
                pdf[l] *= 2.0;
                if s[l] + r[l] > 1.0 {
                    (s[l], r[l]) = (1.0 - s[l], 1.0 - r[l]);
                }
            }
        }
        DrawnLight {
            draw: LightDraw { patch, square },
            at: [s, r],
            pdf,
        }
    }

    /// Points of the lights, drawn as those of light samples are.
    pub fn light_points(&self) -> V3<Lane> {
        let DrawnLight {
            draw, at: [s, r], ..
        } = self.draw_light();
        self.view.patch_points(&draw.patch, &s, &r)
    }
}

impl SceneView<'_> {
    /// [`triangle_irradiance`] of each lane's patch at (s, r).
    pub fn patch_irradiance(
        &self,
        surface: &Surface,
        patch: &[u32; LANES],
        s: &[f32; LANES],
        r: &[f32; LANES],
    ) -> Lane {
        let (q, b) = self.patch_corners(patch, s, r);
        let [q0, q1, q2] = gather(&q, |v, _| self.geometry.positions[v as usize]);
        triangle_irradiance(surface.x, surface.n, [q0, q1, q2], b[0], b[1])
    }

    /// The light triangle's vertices and barycentrics in each lane.
    pub fn patch_corners(
        &self,
        patch: &[u32; LANES],
        s: &[f32; LANES],
        r: &[f32; LANES],
    ) -> ([[u32; 3]; LANES], [Lane; 2]) {
        let mut corners = [[0; 3]; LANES];
        let mut b = [[0.0; LANES]; 2];
        for l in 0..LANES {
            let at;
            (corners[l], at) = self.lights.patches[patch[l] as usize].vertices_at(s[l], r[l]);
            (b[0][l], b[1][l]) = (at[0], at[1]);
        }
        (corners, b.map(Lane::new))
    }

    /// Points of each lane's patch.
    pub fn patch_points(
        &self,
        patch: &[u32; LANES],
        s: &[f32; LANES],
        r: &[f32; LANES],
    ) -> V3<Lane> {
        let points: [Vec3; LANES] =
            std::array::from_fn(|l| self.lights.patches[patch[l] as usize].point(s[l], r[l]));
        from_lanes(&points)
    }

    /// Radiance emitted toward where the ray came from, of each lane's triangle.
    pub fn emission(&self, vertices: &Vertices) -> V3<Lane> {
        if self.lights.is_empty() {
            return V3::splat(0.0);
        }
        let b = self.lights.any_texture.then(|| self.barycentrics(vertices));
        self.per_lane(&vertices.triangle, |mesh, lane| {
            let Some(light) = self.lights.of_mesh[mesh] else {
                return [0.0; 3];
            };
            if !self.sees_front(vertices, lane) {
                return [0.0; 3];
            }
            let texture = self.scene.area_lights[light as usize].radiance;
            match b {
                None => self.scene.constant(texture),
                Some(b) => {
                    let at = b.map(|b| b.to_array()[lane]);
                    let triangle = vertices.triangle[lane];
                    let (found, _) = texture_at(self.scene, self.geometry, texture, triangle, at);
                    found.value.to_array()
                }
            }
        })
    }

    /// Barycentrics of the second and third vertex where the rays end.
    pub fn barycentrics(&self, vertices: &Vertices) -> [Lane; 2] {
        let corners = self.geometry.corners(&vertices.triangle);
        let [v0, v1, v2] = self.geometry.gather_positions(&corners);
        let (_, b1, b2) = triangle_hit(vertices.origin, vertices.direction, v0, v1, v2);
        [b1, b2]
    }

    /// Radiance of each lane's patch where it was sampled.
    pub fn light_radiance(&self, light: &LightSamples) -> V3<Lane> {
        if self.scene.area_lights.len() == 1 && !self.lights.any_texture {
            return splat(Vec3::from(
                self.scene.constant(self.scene.area_lights[0].radiance),
            ));
        }
        let (s, r) = (light.s.to_array(), light.r.to_array());
        from_lanes(&std::array::from_fn(|l| {
            Vec3::from(self.patch_radiance(light.patch[l], s[l], r[l]))
        }))
    }

    /// Radiance of a patch at (s, r).
    pub fn patch_radiance(&self, patch: u32, s: f32, r: f32) -> Rgb {
        let patch = &self.lights.patches[patch as usize];
        let texture = self.scene.area_lights[patch.light as usize].radiance;
        if self.scene.textures[texture].layout == Layout::Constant {
            return self.scene.constant(texture);
        }
        let (triangle, b) = patch.triangle_at(s, r);
        let (found, _) = texture_at(self.scene, self.geometry, texture, triangle, b);
        found.value.to_array()
    }

    /// What the light samples bring, before the throughput.
    pub fn sampled_light(&self, vertices: &Vertices) -> V3<Lane> {
        let lit = vertices.light.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return V3::splat(0.0);
        }
        let light = &vertices.light;
        let value = self.light_radiance(light) * (light.irradiance * light.weight);
        V3::select(lit, value.times(light.value), V3::splat(0.0))
    }
}
