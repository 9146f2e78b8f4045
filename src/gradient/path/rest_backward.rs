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

/// Bounces that rest, and where their cotangents go.
struct Resting<'a> {
    sweep: &'a BackwardSweep<'a>,
    here: &'a Solved<'a>,
    interface: Interface<Lane>,
    /// Where they go.
    w: V3<Lane>,
    /// The cotangent of the logarithm of what is sent along them.
    brings: V3<Lane>,
    bars: &'a mut VertexBars,
}

impl BackwardSweep<'_> {
    /// From the cotangents of the weights of bounces that rest. Returns those of channels in which
    /// nothing is sent: they change as they would if directions turned.
    pub(super) fn rest(
        &self,
        here: &Solved,
        weight_bar: Cotangent,
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let (vertices, bits) = (here.vertices, weight_bar.bits);
        let mut sent = V3::splat(0.0);
        let (Some(interface), true) = (here.interface, bits != 0) else {
            return sent;
        };
        let mut resting = Resting {
            sweep: self,
            here,
            interface,
            w: self.unhidden_bounce(here).0,
            brings: weight_bar.value.times(vertices.weight),
            bars,
        };
        let kinds = vertices.kinds;
        if bits & kinds.dielectric != 0 {
            sent = sent + resting.glass(bits & kinds.dielectric);
        }
        if bits & kinds.plastic != 0 {
            sent = sent + resting.coat(bits & kinds.plastic);
        }
        if let Some((layers, _)) = &here.layers {
            let layered = bits & kinds.principled;
            let through = layered & vertices.lobes.refracted;
            if through != 0 {
                sent = sent + resting.through_layers(layers, through);
            }
            if layered & !through != 0 {
                sent = sent + resting.on_layers(layers, layered & !through);
            }
        }
        let metal = bits & !(kinds.dielectric | kinds.plastic | kinds.principled);
        if metal != 0 {
            sent = sent + resting.metal(metal);
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
}

/// All return what is sent in these lanes, zero in others.
impl Resting<'_> {
    fn glass(&mut self, bits: u32) -> V3<Lane> {
        let (n, direction, w, s) = self.rays();
        let (is_glass, masks) = (lane_mask(bits), self.here.vertices.kinds.masks());
        let sent = bsdf_evaluate_glass(n, direction, w, s, is_glass, masks);
        let (bar, shown) = self.of_unhidden(bits, sent);
        let (n, direction, _, s) =
            bsdf_evaluate_glass_adjoint(n, direction, w, s, is_glass, masks, bar.value);
        self.add(bits, (n, direction, &s));
        shown
    }

    /// What lies below a coat has a lobe of its own.
    fn coat(&mut self, bits: u32) -> V3<Lane> {
        let (n, direction, w, mut s) = self.rays();
        s.reflectance = V3::splat(0.0);
        let (masks, none) = (self.here.vertices.kinds.masks(), RoughTransmission::none());
        let has_lobe = lane_mask(bits);
        let value = bsdf_evaluate(n, direction, w, s, none, masks, has_lobe);
        let (bar, shown) = self.of_unhidden(bits, value * direction_irradiance(n, w));
        let bar = self.of_irradiance(value, bar);
        let (n, direction, _, mut s_bar, _) =
            bsdf_evaluate_adjoint(n, direction, w, s, none, masks, has_lobe, bar);
        s_bar.reflectance = s.reflectance;
        self.add(bits, (n, direction, &s_bar));
        shown
    }

    fn through_layers(&mut self, layers: &Layers<Lane>, bits: u32) -> V3<Lane> {
        let (n, direction, w, s) = self.rays();
        let (is_through, masks) = (lane_mask(bits), self.here.vertices.kinds.masks());
        let sent = layered_sent(n, direction, w, s, *layers, masks, is_through);
        let (bar, shown) = self.of_unhidden(bits, sent);
        let (n, direction, _, s, l) =
            layered_sent_adjoint(n, direction, w, s, *layers, masks, is_through, bar.value);
        self.add(bits, (n, direction, &s));
        self.bars.add_layers(bits, &l);
        shown
    }

    fn on_layers(&mut self, layers: &Layers<Lane>, bits: u32) -> V3<Lane> {
        let (n, direction, w, s) = self.rays();
        let masks = self.here.vertices.kinds.masks();
        let [with, without] = self.here.vertices.lobes.lit_alone();
        let evaluate = |lit| layered_evaluate(n, direction, w, s, *layers, masks, lit);
        let value = evaluate(with) - evaluate(without);
        let (bar, shown) = self.of_unhidden(bits, value * direction_irradiance(n, w));
        let bar = self.of_irradiance(value, bar);
        for (lit, bar) in [(with, bar), (without, -bar)] {
            let (n, direction, _, s, l) =
                layered_evaluate_adjoint(n, direction, w, s, *layers, masks, lit, bar);
            self.add(bits, (n, direction, &s));
            self.bars.add_layers(bits, &l);
        }
        shown
    }

    fn metal(&mut self, bits: u32) -> V3<Lane> {
        let (sweep, here, w) = (self.sweep, self.here, self.w);
        let value = sweep.bsdf_evaluate(here, w, LightKind::Delta);
        let sent = masked(bits, value * direction_irradiance(here.n, w));
        let bar = Cotangent::of_lanes(bits, over(self.brings, sent));
        let bar = Cotangent::of_lanes(bits, self.of_irradiance(value, bar));
        sweep.bsdf_evaluate_backward(here, w, LightKind::Delta, bar, self.bars);
        sent
    }

    /// The normal, the arriving ray, the bounce, and what is met.
    fn rays(&self) -> (V3<Lane>, V3<Lane>, V3<Lane>, Interface<Lane>) {
        let arriving = self.here.vertices.direction;
        (self.here.n, arriving, self.w, self.interface)
    }

    /// The cotangent, in some lanes, of what would be sent if a turned surface hid nothing of
    /// itself, which is `value`; and what it does send.
    fn of_unhidden(&mut self, bits: u32, value: V3<Lane>) -> (Cotangent, V3<Lane>) {
        let (sweep, here, w) = (self.sweep, self.here, self.w);
        let shown = masked(bits, sweep.shown(here, w, value));
        let bar = Cotangent::of_lanes(bits, over(self.brings, shown));
        let (_, value) = sweep.shown_backward(here, (w, value), bar, self.bars);
        (Cotangent { bits, value }, shown)
    }

    /// From the cotangent of a value times its irradiance to that of the value.
    fn of_irradiance(&mut self, value: V3<Lane>, bar: Cotangent) -> V3<Lane> {
        let (n, w, bits) = (self.here.n, self.w, bar.bits);
        let (n_bar, _) = direction_irradiance_adjoint(n, w, masked(bits, value).dot(bar.value));
        self.bars.n = self.bars.n + masked(bits, n_bar);
        bar.value * direction_irradiance(n, w)
    }

    /// Adds the cotangents of the normal, of the arriving ray and of the interface.
    fn add(&mut self, bits: u32, (n, direction, s): (V3<Lane>, V3<Lane>, &Interface<Lane>)) {
        let bars = &mut *self.bars;
        bars.n = bars.n + masked(bits, n);
        bars.direction = bars.direction + masked(bits, direction);
        bars.add_interface(bits, s);
    }
}
