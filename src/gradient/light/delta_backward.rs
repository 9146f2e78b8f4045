//! The backward sweep over delta lights.

use crate::adjoint::bsdf::bsdf_evaluate_glass_adjoint;
use crate::adjoint::layered::layered_sent_adjoint;
use crate::adjoint::light::{
    direction_irradiance_adjoint, point_falloff_adjoint, point_irradiance_adjoint,
};
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, VertexBars};
use crate::gradient::scene::backward::TileSums;
use crate::kernels::bsdf::bsdf_evaluate_glass;
use crate::kernels::layered::layered_sent;
use crate::kernels::light::{direction_irradiance, point_falloff, point_irradiance};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::light::beam::{intensity, power_toward};
use crate::paths::light::delta::toward;
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked, splat};
use crate::paths::store::TileStore;
use crate::paths::surface::kinds::LightKind;
use crate::scene::{DeltaLight, DeltaLightKind};
use glam::Vec3;

impl BackwardSweep<'_> {
    pub(crate) fn delta_lights(
        &self,
        store: &TileStore,
        here: &Solved,
        radiance_bar: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let sights = store.delta_visible(here.vertices);
        let glass = here.vertices.kinds.rough_glass();
        for ((i, light), sight) in self.view.delta_lights.iter().enumerate().zip(sights) {
            let seen = sight.seen;
            for (bits, is_glass) in [(seen & !glass, false), (seen & glass, true)] {
                if bits == 0 {
                    continue;
                }
                let bar = Cotangent::of_lanes(bits, radiance_bar);
                let moved = if is_glass {
                    self.through_glass(light, here, bar, bars, sums)
                } else {
                    self.onto_surfaces(light, here, bar, bars, sums)
                };
                let moved = sums.over_lanes(moved, bits);
                sums.delta_lights[i] += moved;
            }
        }
    }

    /// What a light brings to surfaces; returns the cotangent of its position.
    fn onto_surfaces(
        &self,
        light: &DeltaLight,
        here: &Solved,
        bar: Cotangent,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> V3<Lane> {
        let Cotangent {
            bits,
            value: radiance_bar,
        } = bar;
        let (w, _) = toward(light, here.x);
        let irradiance = match light.kind {
            DeltaLightKind::Point { position } => point_irradiance(here.x, here.n, splat(position)),
            DeltaLightKind::Directional { .. } => direction_irradiance(here.n, w),
        };
        let power = power_toward(&self.view.scene.textures, light, -w);
        let value = self.bsdf_evaluate(here, w, LightKind::Delta);
        let path = radiance_bar.times(here.vertices.throughput);
        let away_bar = self.power(light, here, bar, value * irradiance, power, bars, sums);
        let value_bar = Cotangent::of_lanes(bits, path.times(power) * irradiance);
        let w_bar = self.bsdf_evaluate_backward(here, w, LightKind::Delta, value_bar, bars);
        let all = path.times(value).times(power);
        let irradiance_bar = all.x + all.y + all.z;
        match light.kind {
            DeltaLightKind::Point { position } => {
                let p = splat(position);
                let (x, n, p) = point_irradiance_adjoint(here.x, here.n, p, irradiance_bar);
                let w_bar = w_bar - away_bar;
                bars.x = bars.x + masked(bits, x - w_bar);
                bars.n = bars.n + masked(bits, n);
                masked(bits, p + w_bar)
            }
            DeltaLightKind::Directional { .. } => {
                let (n, _) = direction_irradiance_adjoint(here.n, w, irradiance_bar);
                bars.n = bars.n + masked(bits, n);
                V3::splat(0.0)
            }
        }
    }

    /// What rough glass sends on of a light; returns the cotangent of the light's position.
    fn through_glass(
        &self,
        light: &DeltaLight,
        here: &Solved,
        bar: Cotangent,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> V3<Lane> {
        let Cotangent {
            bits,
            value: radiance_bar,
        } = bar;
        let Some(interface) = here.interface else {
            return V3::splat(0.0);
        };
        let (w, _) = toward(light, here.x);
        let falloff = match light.kind {
            DeltaLightKind::Point { position } => point_falloff(here.x, splat(position)),
            DeltaLightKind::Directional { .. } => Lane::splat(1.0),
        };
        let kinds = here.vertices.kinds.masks();
        let (n, direction, is_glass) = (here.n, here.vertices.direction, lane_mask(bits));
        let layered = bits & here.vertices.kinds.layered();
        let plain = bits & !layered;
        let mut sent = bsdf_evaluate_glass(n, direction, w, interface, is_glass, kinds);
        if let Some((layers, _)) = here.layers {
            let is_layered = lane_mask(layered);
            let own = layered_sent(n, direction, w, interface, layers, kinds, is_layered);
            sent = V3::select(is_layered, own, sent);
        }
        let unhidden = sent;
        let sent = self.shown(here, w, sent);
        let power = power_toward(&self.view.scene.textures, light, -w);
        let away_bar = self.power(light, here, bar, sent * falloff, power, bars, sums);
        let arriving = radiance_bar.times(here.vertices.throughput).times(power);
        let sent_bar = Cotangent::of_lanes(bits, arriving * falloff);
        let (hidden_w, sent_bar) = self.shown_backward(here, (w, unhidden), sent_bar, bars);
        let mut w_bar = hidden_w;
        if let Some((layers, _)) = here.layers {
            let bar = masked(layered, sent_bar);
            let is_layered = lane_mask(layered);
            let (n, direction, own, s, l) =
                layered_sent_adjoint(n, direction, w, interface, layers, kinds, is_layered, bar);
            bars.n = bars.n + masked(layered, n);
            bars.direction = bars.direction + masked(layered, direction);
            bars.add_interface(layered, &s);
            bars.add_layers(layered, &l);
            w_bar = w_bar + masked(layered, own);
        }
        let (n, direction, own, s) = bsdf_evaluate_glass_adjoint(
            n,
            direction,
            w,
            interface,
            is_glass,
            kinds,
            masked(plain, sent_bar),
        );
        bars.n = bars.n + masked(plain, n);
        bars.direction = bars.direction + masked(plain, direction);
        bars.add_interface(plain, &s);
        w_bar = w_bar + masked(plain, own);
        let DeltaLightKind::Point { position } = light.kind else {
            return V3::splat(0.0);
        };
        let all = arriving.times(sent);
        let (x, p) = point_falloff_adjoint(here.x, splat(position), all.x + all.y + all.z);
        let w_bar = w_bar - away_bar;
        bars.x = bars.x + masked(bits, x - w_bar);
        masked(bits, p + w_bar)
    }

    /// The cotangents of the light's power and of the path's weight; `brings` is what arrives per
    /// unit of power. Returns that of the way from the light, along which a beam differs.
    // What arrives, what it is of, and where its cotangents go.
    #[allow(clippy::too_many_arguments)]
    fn power(
        &self,
        light: &DeltaLight,
        here: &Solved,
        Cotangent { bits, value }: Cotangent,
        brings: V3<Lane>,
        power: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> V3<Lane> {
        let scene = self.view.scene;
        let own = value.times(brings).times(power);
        bars.throughput = bars.throughput + masked(bits, own);
        let path = value.times(here.vertices.throughput);
        let Some(beam) = &light.beam else {
            let power_bar = sums.over_lanes(path.times(brings), bits);
            sums.add_texel(self.wanted, light.power, 0, power_bar.as_vec3());
            return V3::splat(0.0);
        };
        let (w, _) = toward(light, here.x);
        let mut away_bars = [Vec3::ZERO; LANES];
        for lane in (0..LANES).filter(|&l| bits >> l & 1 == 1) {
            let away = -lane_of(w, lane);
            let Some(found) = intensity(&scene.textures, light, beam, away) else {
                continue;
            };
            let bar = lane_of(path.times(brings), lane);
            let (power_bar, picture_bar, local_bar) = found.cotangents(bar);
            sums.add_texture(self.wanted, light.power, &found.power, power_bar);
            if let Some((texture, picture)) = &found.picture {
                sums.add_texture(self.wanted, *texture, picture, picture_bar);
            }
            away_bars[lane] = beam.to_local.transpose() * local_bar;
        }
        from_lanes(&away_bars)
    }
}
