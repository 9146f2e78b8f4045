//! The forward sweep over delta lights.

use crate::gradient::path::forward::{D, ForwardSweep, MovingVertex, constant, value_of};
use crate::gradient::scene::forward::{dual_vector, tangent_of};
use crate::kernels::bsdf::bsdf_evaluate_glass;
use crate::kernels::layered::layered_sent;
use crate::kernels::light::{direction_irradiance, point_falloff, point_irradiance};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::light::beam::intensity;
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked, splat};
use crate::paths::store::TileStore;
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::texture::Lookup;
use crate::scene::{DeltaLight, DeltaLightKind};
use glam::Vec3;

impl ForwardSweep<'_> {
    pub(crate) fn delta_lights(&self, store: &TileStore, here: &MovingVertex) -> V3<Lane> {
        let sights = store.delta_visible(here.vertices);
        let mut sum = V3::splat(0.0);
        for ((i, light), sight) in self.view.delta_lights.iter().enumerate().zip(sights) {
            let seen = sight.seen;
            if seen == 0 {
                continue;
            }
            let still = |v: Vec3| dual_vector(splat(v), V3::splat(0.0));
            let (w, irradiance, falloff) = match light.kind {
                DeltaLightKind::Point { position } => {
                    let p = dual_vector(splat(position), splat(self.motion.delta_lights[i]));
                    let irradiance = point_irradiance(here.x, here.n, p);
                    (p - here.x, irradiance, point_falloff(here.x, p))
                }
                DeltaLightKind::Directional { direction } => {
                    let w = still(-direction);
                    let one = constant(Lane::splat(1.0));
                    (w, direction_irradiance(here.n, w), one)
                }
            };
            let power = self.delta_power(light, w);
            let mut brings = self.bsdf_evaluate(here, w, LightKind::Delta) * irradiance;
            let glass = here.vertices.kinds.rough_glass();
            if let (Some(interface), true) = (&here.interface, glass & seen != 0) {
                let (n, is_glass) = (here.n, lane_mask(glass));
                let direction = here.direction;
                let sent = bsdf_evaluate_glass::<D>(
                    n,
                    direction,
                    w,
                    *interface,
                    is_glass,
                    here.vertices.kinds.masks(),
                );
                let kinds = &here.vertices.kinds;
                let sent = match here.layers {
                    None => sent,
                    Some(layers) => {
                        let is_layered = lane_mask(glass & kinds.layered());
                        let own = layered_sent::<D>(
                            n,
                            direction,
                            w,
                            *interface,
                            layers,
                            kinds.masks(),
                            is_layered,
                        );
                        V3::select(is_layered, own, sent)
                    }
                };
                let sent = self.shown(here, w, sent);
                brings = V3::select(is_glass, sent * falloff, brings);
            }
            let arrives = brings.times(power);
            sum = sum + masked(seen, tangent_of(here.throughput.times(arrives)));
        }
        sum
    }

    /// The power toward a point `w` away, which moves with both, and with the light's textures.
    fn delta_power(&self, light: &DeltaLight, w: V3<D>) -> V3<D> {
        let scene = self.view.scene;
        let Some(beam) = &light.beam else {
            return dual_vector(
                splat(Vec3::from(scene.constant(light.power))),
                splat(Vec3::from(self.motion.texel(light.power))),
            );
        };
        let changed = |texture: usize, found: &Lookup| self.motion.texture(texture, found);
        let mut values = [Vec3::ZERO; LANES];
        let mut tangents = [Vec3::ZERO; LANES];
        for lane in 0..LANES {
            let away = -lane_of(value_of(w), lane);
            let Some(found) = intensity(&scene.textures, light, beam, away) else {
                continue;
            };
            let local = beam.to_local * -lane_of(tangent_of(w), lane);
            let picture = found.picture.map_or(Vec3::ZERO, |(t, f)| changed(t, &f));
            values[lane] = found.value();
            tangents[lane] = found.tangent(changed(light.power, &found.power), picture, local);
        }
        dual_vector(from_lanes(&values), from_lanes(&tangents))
    }
}
