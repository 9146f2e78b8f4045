//! Delta lights: points and directions. They light whatever is not perfectly smooth.

use crate::kernels::light::{direction_irradiance, point_falloff, point_irradiance};
use crate::lanes::{Lane, Real, V3};
use crate::paths::rays::{RayPacket, SHADOW_FAR, lane_mask, masked, splat};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{TileStore, Vertices};
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::vertex::Surface;
use crate::scene::{DeltaLight, DeltaLightKind};
use glam::Vec3;

impl SceneView<'_> {
    /// Looks at every delta light.
    pub fn see_delta_lights(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        store: &mut TileStore,
    ) {
        let kinds = &vertices.kinds;
        let both_sides = kinds.rough_glass();
        let lit = kinds.lit_by_delta_lights() | both_sides;
        let lit = vertices.hit & lit & !self.reflects_nothing(vertices);
        let first = store.delta_visible.len() as u32;
        for light in &self.scene.delta_lights {
            let (w, far) = toward(light, surface.x);
            let above = surface.n.dot(w).gt(Lane::splat(0.0)).to_bits() | both_sides;
            let rays = RayPacket {
                far,
                ..RayPacket::leaving(surface.x, surface.geometric, w, lit & above)
            };
            let seen = self.unoccluded(&rays, &mut store.counts.shadow);
            store.delta_visible.push(seen);
        }
        vertices.delta_lights = [first, store.delta_visible.len() as u32];
    }

    /// Radiance that delta lights bring, before the throughput.
    pub fn delta_light(&self, vertices: &Vertices, surface: &Surface, visible: &[u32]) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        let glass = vertices.kinds.rough_glass();
        for (light, &seen) in self.scene.delta_lights.iter().zip(visible) {
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
            let power = splat(Vec3::from(self.scene.constant(light.power)));
            sum = sum + masked(seen, brings.times(power));
        }
        sum
    }
}

/// The way from `x` to a delta light, and how much of it shadow rays go.
pub fn toward(light: &DeltaLight, x: V3<Lane>) -> (V3<Lane>, f32) {
    match light.kind {
        DeltaLightKind::Point { position } => (splat(position) - x, SHADOW_FAR),
        DeltaLightKind::Directional { direction } => (splat(-direction), f32::INFINITY),
    }
}
