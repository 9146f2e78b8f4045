//! The backward sweep over bounces in rough metal and glass that rest in the world; see
//! `rest_forward`.

use crate::adjoint::bsdf::bsdf_evaluate_glass_adjoint;
use crate::adjoint::light::direction_irradiance_adjoint;
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, VertexBars};
use crate::kernels::bsdf::{bsdf_evaluate_glass, bsdf_sample};
use crate::kernels::light::direction_irradiance;
use crate::lanes::{Lane, Real, V3};
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
        let masks = kinds.masks();
        let none = self.view.transmission(vertices, n, vertices.local.z);
        let lobes = vertices.lobes.masks();
        let (w, _) = bsdf_sample(n, direction, vertices.local, interface, none, lobes, masks);
        let brings = weight_bar.value.times(vertices.weight);
        let glass = weight_bar.bits & kinds.dielectric;
        if glass != 0 {
            let is_glass = lane_mask(glass);
            let sent = bsdf_evaluate_glass(n, direction, w, interface, is_glass, masks);
            let bar = masked(glass, over(brings, sent));
            let (n_bar, direction_bar, _, s_bar) =
                bsdf_evaluate_glass_adjoint(n, direction, w, interface, is_glass, masks, bar);
            bars.n = bars.n + masked(glass, n_bar);
            bars.direction = bars.direction + masked(glass, direction_bar);
            bars.add_interface(glass, &s_bar);
        }
        let metal = weight_bar.bits & !kinds.dielectric;
        if metal != 0 {
            let value = self.bsdf_evaluate(here, w, LightKind::Delta);
            let irradiance = direction_irradiance(n, w);
            let bar = over(brings, value * irradiance);
            let all = bar.times(value);
            let (n_bar, _) = direction_irradiance_adjoint(n, w, all.x + all.y + all.z);
            bars.n = bars.n + masked(metal, n_bar);
            let value_bar = Cotangent::of_lanes(metal, bar * irradiance);
            self.bsdf_evaluate_backward(here, w, LightKind::Delta, value_bar, bars);
        }
    }
}

/// One over the other where that is not zero, else zero.
fn over(a: V3<Lane>, b: V3<Lane>) -> V3<Lane> {
    let zero = Lane::splat(0.0);
    let part = |a: Lane, b: Lane| <Lane as Real>::select(b.gt(zero), a / b, zero);
    V3::new(part(a.x, b.x), part(a.y, b.y), part(a.z, b.z))
}
