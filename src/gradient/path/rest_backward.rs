//! The backward sweep over bounces in rough metal, glass and plastic that rest in the world;
//! see `rest_forward`.

use crate::adjoint::bsdf::{bsdf_evaluate_adjoint, bsdf_evaluate_glass_adjoint};
use crate::adjoint::layered::{layered_evaluate_adjoint, layered_sent_adjoint};
use crate::adjoint::light::direction_irradiance_adjoint;
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, VertexBars, over};
use crate::kernels::bsdf::{Interface, RoughTransmission, bsdf_evaluate, bsdf_evaluate_glass};
use crate::kernels::layered::{Layers, layered_evaluate, layered_sent};
use crate::kernels::light::direction_irradiance;
use crate::lanes::{Lane, Real, V3};
use crate::paths::rays::{lane_mask, masked};
use crate::paths::surface::kinds::LightKind;

impl BackwardSweep<'_> {
    /// From the cotangents of the weights of bounces that rest. Returns those of channels in which
    /// nothing is sent: they change as they would if directions turned.
    pub(super) fn rest(
        &self,
        here: &Solved,
        weight_bar: Cotangent,
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let none = V3::splat(0.0);
        let (Some(interface), true) = (here.interface, weight_bar.bits != 0) else {
            return none;
        };
        let kinds = vertices.kinds;
        let (w, _) = self.unhidden_bounce(here);
        let brings = weight_bar.value.times(vertices.weight);
        let mut sent = none;
        let glass = weight_bar.bits & kinds.dielectric;
        if glass != 0 {
            sent = sent + self.rest_of_glass(here, &interface, w, (glass, brings), bars);
        }
        let coat = weight_bar.bits & kinds.plastic;
        if coat != 0 {
            sent = sent + self.rest_of_coat(here, &interface, w, (coat, brings), bars);
        }
        let layered = weight_bar.bits & kinds.principled;
        if let Some((layers, _)) = &here.layers {
            let of = (&interface, layers);
            let through = layered & vertices.lobes.refracted;
            if through != 0 {
                sent = sent + self.rest_through_layers(here, of, w, (through, brings), bars);
            }
            let above = layered & !through;
            if above != 0 {
                sent = sent + self.rest_on_layers(here, of, w, (above, brings), bars);
            }
        }
        let metal = weight_bar.bits & !(kinds.dielectric | kinds.plastic | kinds.principled);
        if metal != 0 {
            let value = self.bsdf_evaluate(here, w, LightKind::Delta);
            let all = masked(metal, value * direction_irradiance(here.n, w));
            let bar = Cotangent::of_lanes(metal, over(brings, all));
            let bar = Cotangent::of_lanes(metal, of_irradiance(here, w, (value, bar), bars));
            self.bsdf_evaluate_backward(here, w, LightKind::Delta, bar, bars);
            sent = sent + all;
        }
        let zero = Lane::splat(0.0);
        let left = |sent: Lane, bar: Lane| <Lane as Real>::select(sent.gt(zero), zero, bar);
        let bar = weight_bar.value;
        V3::new(
            left(sent.x, bar.x),
            left(sent.y, bar.y),
            left(sent.z, bar.z),
        )
    }

    fn rest_of_glass(
        &self,
        here: &Solved,
        interface: &Interface<Lane>,
        w: V3<Lane>,
        (bits, brings): (u32, V3<Lane>),
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let (n, direction, s) = (here.n, here.vertices.direction, *interface);
        let (is_glass, masks) = (lane_mask(bits), here.vertices.kinds.masks());
        let sent = bsdf_evaluate_glass(n, direction, w, s, is_glass, masks);
        let (bar, shown) = self.of_unhidden(here, (w, sent), (bits, brings), bars);
        let (n, direction, _, s) =
            bsdf_evaluate_glass_adjoint(n, direction, w, s, is_glass, masks, bar.value);
        add(bits, (n, direction, &s), bars);
        shown
    }

    /// What lies below a coat has a lobe of its own.
    fn rest_of_coat(
        &self,
        here: &Solved,
        interface: &Interface<Lane>,
        w: V3<Lane>,
        (bits, brings): (u32, V3<Lane>),
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let (n, direction) = (here.n, here.vertices.direction);
        let (masks, none) = (here.vertices.kinds.masks(), RoughTransmission::none());
        let reflectance = V3::splat(0.0);
        let coat = Interface {
            reflectance,
            ..*interface
        };
        let has_lobe = lane_mask(bits);
        let value = bsdf_evaluate(n, direction, w, coat, none, masks, has_lobe);
        let sent = value * direction_irradiance(n, w);
        let (bar, shown) = self.of_unhidden(here, (w, sent), (bits, brings), bars);
        let bar = of_irradiance(here, w, (value, bar), bars);
        let (n, direction, _, mut s, _) =
            bsdf_evaluate_adjoint(n, direction, w, coat, none, masks, has_lobe, bar);
        s.reflectance = reflectance;
        add(bits, (n, direction, &s), bars);
        shown
    }

    fn rest_through_layers(
        &self,
        here: &Solved,
        (interface, layers): (&Interface<Lane>, &Layers<Lane>),
        w: V3<Lane>,
        (bits, brings): (u32, V3<Lane>),
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let (n, direction, s) = (here.n, here.vertices.direction, *interface);
        let (is_through, masks) = (lane_mask(bits), here.vertices.kinds.masks());
        let sent = layered_sent(n, direction, w, s, *layers, masks, is_through);
        let (bar, shown) = self.of_unhidden(here, (w, sent), (bits, brings), bars);
        let (n, direction, _, s, l) =
            layered_sent_adjoint(n, direction, w, s, *layers, masks, is_through, bar.value);
        add(bits, (n, direction, &s), bars);
        bars.add_layers(bits, &l);
        shown
    }

    fn rest_on_layers(
        &self,
        here: &Solved,
        (interface, layers): (&Interface<Lane>, &Layers<Lane>),
        w: V3<Lane>,
        (bits, brings): (u32, V3<Lane>),
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let (n, direction, s) = (here.n, here.vertices.direction, *interface);
        let masks = here.vertices.kinds.masks();
        let [with, without] = here.vertices.lobes.lit_alone();
        let evaluate = |lit| layered_evaluate(n, direction, w, s, *layers, masks, lit);
        let value = evaluate(with) - evaluate(without);
        let sent = value * direction_irradiance(n, w);
        let (bar, shown) = self.of_unhidden(here, (w, sent), (bits, brings), bars);
        let bar = of_irradiance(here, w, (value, bar), bars);
        for (lit, bar) in [(with, bar), (without, -bar)] {
            let (n, direction, _, s, l) =
                layered_evaluate_adjoint(n, direction, w, s, *layers, masks, lit, bar);
            add(bits, (n, direction, &s), bars);
            bars.add_layers(bits, &l);
        }
        shown
    }

    /// The cotangent of what would be sent along `w` if a turned surface hid nothing of itself, in
    /// some lanes, and what it does send; `brings` is the cotangent of the logarithm of that.
    fn of_unhidden(
        &self,
        here: &Solved,
        (w, value): (V3<Lane>, V3<Lane>),
        (bits, brings): (u32, V3<Lane>),
        bars: &mut VertexBars,
    ) -> (Cotangent, V3<Lane>) {
        let shown = masked(bits, self.shown(here, w, value));
        let bar = Cotangent::of_lanes(bits, over(brings, shown));
        let (_, value) = self.shown_backward(here, (w, value), bar, bars);
        (Cotangent { bits, value }, shown)
    }
}

/// From the cotangent of a value times its irradiance, in some lanes, to that of the value.
fn of_irradiance(
    here: &Solved,
    w: V3<Lane>,
    (value, bar): (V3<Lane>, Cotangent),
    bars: &mut VertexBars,
) -> V3<Lane> {
    let bits = bar.bits;
    let (n, _) = direction_irradiance_adjoint(here.n, w, masked(bits, value).dot(bar.value));
    bars.n = bars.n + masked(bits, n);
    bar.value * direction_irradiance(here.n, w)
}

/// Adds the cotangents of a normal, of the arriving ray and of an interface.
fn add(
    bits: u32,
    (n, direction, s): (V3<Lane>, V3<Lane>, &Interface<Lane>),
    bars: &mut VertexBars,
) {
    bars.n = bars.n + masked(bits, n);
    bars.direction = bars.direction + masked(bits, direction);
    bars.add_interface(bits, s);
}
