//! Delta lights: points and directions. They light whatever is not perfectly smooth.

use crate::kernels::light::{direction_irradiance, point_falloff, point_irradiance};
use crate::lanes::{Lane, Real, V3};
use crate::paths::leaving::SHADOW_FAR;
use crate::paths::light::beam::power_toward;
use crate::paths::rays::{RayPacket, lane_mask, masked, splat};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{DeltaSight, TileStore, Vertices};
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::vertex::Surface;
use crate::scene::{DeltaLight, DeltaLightKind};

impl SceneView<'_> {
    /// Looks at every delta light.
    pub fn see_delta_lights(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        store: &mut TileStore,
    ) {
        let first = store.delta_visible.len() as u32;
        let counted = &mut store.counts.shadow;
        for light in self.delta_lights {
            let sight = self.delta_sight(light, vertices, surface, counted);
            store.delta_visible.push(sight);
        }
        vertices.delta_lights = [first, store.delta_visible.len() as u32];
    }

    /// Which lanes see a delta light, of those that it may light; the rays are added to `count`.
    pub fn delta_sight(
        &self,
        light: &DeltaLight,
        vertices: &Vertices,
        surface: &Surface,
        count: &mut u64,
    ) -> DeltaSight {
        let kinds = &vertices.kinds;
        let both_sides = kinds.rough_glass();
        let lit = kinds.lit_by_delta_lights() | both_sides;
        let lit = vertices.hit & lit & !self.reflects_nothing(vertices);
        let (w, far) = toward(light, surface.x);
        let above = surface.n.dot(w).gt(Lane::splat(0.0)).to_bits() | both_sides;
        let rays = RayPacket {
            far,
            ..self.leaving(surface.x, surface.geometric, w, lit & above)
        };
        let seen = self.unoccluded(&rays, count);
        DeltaSight {
            seen,
            hidden: rays.active & !seen,
        }
    }

    /// Radiance that delta lights bring, before the throughput.
    pub fn delta_light(
        &self,
        vertices: &Vertices,
        surface: &Surface,
        visible: &[DeltaSight],
    ) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        let glass = vertices.kinds.rough_glass();
        for (light, &DeltaSight { seen, .. }) in self.delta_lights.iter().zip(visible) {
            if seen == 0 {
                continue;
            }
            let (w, _) = toward(light, surface.x);
            let (irradiance, falloff) = match light.kind {
                DeltaLightKind::Point { position } => {
                    let p = splat(position);
                    let irradiance = point_irradiance(surface.x, surface.n, p);
                    (irradiance, point_falloff(surface.x, p))
                }
                DeltaLightKind::Directional { .. } => {
                    (direction_irradiance(surface.n, w), Lane::splat(1.0))
                }
            };
            let value = self.bsdf_evaluate(vertices, surface, w, LightKind::Delta);
            let mut brings = value * irradiance;
            if glass & seen != 0 {
                let sent = self.bsdf_sent(vertices, surface, w, glass);
                brings = V3::select(lane_mask(glass), sent * falloff, brings);
            }
            let power = power_toward(&self.scene.textures, light, -w);
            sum = sum + masked(seen, brings.times(power));
        }
        sum
    }
}

/// The way from `x` to a delta light, and how much of it shadow rays go.
pub fn toward<F: Real>(light: &DeltaLight, x: V3<F>) -> (V3<F>, f32) {
    match light.kind {
        DeltaLightKind::Point { position } => (splat(position) - x, SHADOW_FAR),
        DeltaLightKind::Directional { direction } => (splat(-direction), f32::INFINITY),
    }
}
