//! The backward sweep over bounces in rough metal, glass and plastic that rest in the world;
//! see `rest_forward`.

use crate::adjoint::bsdf::{bsdf_evaluate_adjoint, bsdf_evaluate_glass_adjoint};
use crate::adjoint::layered::layered_evaluate_adjoint;
use crate::adjoint::light::direction_irradiance_adjoint;
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, VertexBars, over};
use crate::kernels::bsdf::{Interface, RoughTransmission, bsdf_evaluate, bsdf_evaluate_glass};
use crate::kernels::layered::layered_evaluate;
use crate::kernels::light::direction_irradiance;
use crate::lanes::{Lane, V3};
use crate::paths::rays::{lane_mask, masked};
use crate::paths::surface::kinds::LightKind;

impl BackwardSweep<'_> {
    /// From the cotangents of the weights of bounces that rest.
    pub(super) fn rest(&self, here: &Solved, weight_bar: Cotangent, bars: &mut VertexBars) {
        let vertices = here.vertices;
        let (Some(interface), true) = (here.interface, weight_bar.bits != 0) else {
            return;
        };
        let (n, direction, kinds) = (here.n, vertices.direction, vertices.kinds);
        let (masks, none) = (kinds.masks(), RoughTransmission::none());
        let (w, _) = self.unhidden_bounce(here);
        let brings = weight_bar.value.times(vertices.weight);
        let glass = weight_bar.bits & kinds.dielectric;
        if glass != 0 {
            let is_glass = lane_mask(glass);
            let sent = bsdf_evaluate_glass(n, direction, w, interface, is_glass, masks);
            let bar = self.of_unhidden(here, (w, sent), (glass, brings), bars);
            let (n_bar, direction_bar, _, s_bar) =
                bsdf_evaluate_glass_adjoint(n, direction, w, interface, is_glass, masks, bar);
            bars.n = bars.n + masked(glass, n_bar);
            bars.direction = bars.direction + masked(glass, direction_bar);
            bars.add_interface(glass, &s_bar);
        }
        let coat = weight_bar.bits & kinds.plastic;
        if coat != 0 {
            // What lies below has a lobe of its own.
            let reflectance = V3::splat(0.0);
            let interface = Interface {
                reflectance,
                ..interface
            };
            let (has_lobe, irradiance) = (lane_mask(coat), direction_irradiance(n, w));
            let value = bsdf_evaluate(n, direction, w, interface, none, masks, has_lobe);
            let bar = self.of_unhidden(here, (w, value * irradiance), (coat, brings), bars);
            let all = masked(coat, bar.times(value));
            let (n_bar, _) = direction_irradiance_adjoint(n, w, all.x + all.y + all.z);
            bars.n = bars.n + masked(coat, n_bar);
            let bar = masked(coat, bar * irradiance);
            let (n_bar, direction_bar, _, mut s_bar, _) =
                bsdf_evaluate_adjoint(n, direction, w, interface, none, masks, has_lobe, bar);
            s_bar.reflectance = reflectance;
            bars.n = bars.n + masked(coat, n_bar);
            bars.direction = bars.direction + masked(coat, direction_bar);
            bars.add_interface(coat, &s_bar);
        }
        let layered = weight_bar.bits & kinds.principled;
        if let (Some((layers, _)), true) = (&here.layers, layered != 0) {
            let [with, without] = vertices.lobes.lit_alone();
            let evaluate = |lit| layered_evaluate(n, direction, w, interface, *layers, masks, lit);
            let (value, irradiance) = (
                evaluate(with) - evaluate(without),
                direction_irradiance(n, w),
            );
            let bar = self.of_unhidden(here, (w, value * irradiance), (layered, brings), bars);
            let all = masked(layered, bar.times(value));
            let (n_bar, _) = direction_irradiance_adjoint(n, w, all.x + all.y + all.z);
            bars.n = bars.n + masked(layered, n_bar);
            let bar = masked(layered, bar * irradiance);
            for (lit, bar) in [(with, bar), (without, -bar)] {
                let (n_bar, direction_bar, _, s_bar, l_bar) =
                    layered_evaluate_adjoint(n, direction, w, interface, *layers, masks, lit, bar);
                bars.n = bars.n + masked(layered, n_bar);
                bars.direction = bars.direction + masked(layered, direction_bar);
                bars.add_interface(layered, &s_bar);
                bars.add_layers(layered, &l_bar);
            }
        }
        let metal = weight_bar.bits & !(kinds.dielectric | kinds.plastic | kinds.principled);
        if metal != 0 {
            let value = self.bsdf_evaluate(here, w, LightKind::Delta);
            let irradiance = direction_irradiance(n, w);
            let bar = over(brings, value * irradiance);
            let all = masked(metal, bar.times(value));
            let (n_bar, _) = direction_irradiance_adjoint(n, w, all.x + all.y + all.z);
            bars.n = bars.n + masked(metal, n_bar);
            let value_bar = Cotangent::of_lanes(metal, bar * irradiance);
            self.bsdf_evaluate_backward(here, w, LightKind::Delta, value_bar, bars);
        }
    }

    /// The cotangent of what would be sent along `w` if a turned surface hid nothing of itself, in
    /// some lanes; `brings` is the cotangent of the logarithm of what is sent.
    fn of_unhidden(
        &self,
        here: &Solved,
        (w, value): (V3<Lane>, V3<Lane>),
        (bits, brings): (u32, V3<Lane>),
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let bar = masked(bits, over(brings, self.shown(here, w, value)));
        let bar = Cotangent { bits, value: bar };
        self.shown_backward(here, (w, value), bar, bars).1
    }
}
