//! The forward sweep over bounces in rough metal, glass and plastic that rest in the world: what
//! the lobe sends along them changes, and the density that they were drawn with does not.

use crate::gradient::path::forward::{D, ForwardSweep, MovingVertex, value_of};
use crate::gradient::scene::forward::dual_vector;
use crate::kernels::bsdf::{Interface, bsdf_evaluate_glass};
use crate::kernels::layered::{Layers, layered_evaluate, layered_sent};
use crate::kernels::light::direction_irradiance;
use crate::lanes::{Dual, Lane, Real, V3};
use crate::paths::rays::lane_mask;
use crate::paths::store::Vertices;
use crate::paths::surface::kinds::LightKind;

impl ForwardSweep<'_> {
    /// Bounces and their weights, which turn with the surface, as they are where they rest.
    pub(super) fn rest(
        &self,
        here: &MovingVertex,
        direction: V3<D>,
        weight: V3<D>,
    ) -> (V3<D>, V3<D>) {
        let vertices = here.vertices;
        let rests = vertices.resting_lobes();
        let (Some(interface), true) = (&here.interface, rests != 0) else {
            return (direction, weight);
        };
        let w = dual_vector(value_of(direction), V3::splat(0.0));
        let sent = self.sent(here, interface, w);
        let zero = Lane::splat(0.0);
        let changed = |weight: D, sent: D| Dual {
            value: weight.value,
            tangent: <Lane as Real>::select(
                sent.value.gt(zero),
                weight.value * sent.tangent / sent.value,
                // What is black may become brighter, wherever directions go.
                weight.tangent,
            ),
        };
        let own = V3::new(
            changed(weight.x, sent.x),
            changed(weight.y, sent.y),
            changed(weight.z, sent.z),
        );
        let rests = lane_mask(rests);
        (
            V3::select(rests, w, direction),
            V3::select(rests, own, weight),
        )
    }

    /// What the lobes of rough metal, glass and plastic send of a beam from `w`, but for a factor.
    fn sent(&self, here: &MovingVertex, interface: &Interface<D>, w: V3<D>) -> V3<D> {
        let kinds = here.vertices.kinds;
        let is_plastic = lane_mask(kinds.plastic);
        // What lies below has a lobe of its own.
        let reflectance = V3::select(is_plastic, V3::splat(0.0), interface.reflectance);
        let coat = MovingVertex {
            interface: Some(Interface {
                reflectance,
                ..*interface
            }),
            ..*here
        };
        let mut reflected = self.bsdf_evaluate(&coat, w, LightKind::Delta);
        if let (Some(layers), true) = (&here.layers, kinds.principled != 0) {
            let lobe = self.shown(here, w, lobe_of_layers(here, interface, layers, w));
            reflected = V3::select(lane_mask(kinds.principled), lobe, reflected);
        }
        let mut sent = reflected * direction_irradiance(here.n, w);
        let through = kinds.transmits & here.vertices.lobes.refracted;
        if let (Some(layers), true) = (&here.layers, through != 0) {
            let (n, direction, is_through) = (here.n, here.direction, lane_mask(through));
            let masks = kinds.masks();
            let squeezed =
                layered_sent::<D>(n, direction, w, *interface, *layers, masks, is_through);
            sent = V3::select(is_through, self.shown(here, w, squeezed), sent);
        }
        if kinds.dielectric == 0 {
            return sent;
        }
        let (is_glass, masks) = (lane_mask(kinds.dielectric), kinds.masks());
        let glass =
            bsdf_evaluate_glass::<D>(here.n, here.direction, w, *interface, is_glass, masks);
        V3::select(is_glass, self.shown(here, w, glass), sent)
    }

    /// A direction over a lobe in which a border is seen, likewise.
    pub(crate) fn at_rest(
        &self,
        here: &MovingVertex,
        lane: usize,
        direction: V3<Dual<f64>>,
    ) -> V3<Dual<f64>> {
        let vertices = here.vertices;
        if vertices.resting_lobes() >> lane & 1 == 0 {
            return direction;
        }
        let value = |d: Dual<f64>| d.value;
        let V3 { x, y, z } = direction;
        dual_vector(V3::new(value(x), value(y), value(z)), V3::splat(0.0))
    }
}

/// π times what the lobe that was drawn of each lane's layers sends of light from `w`.
fn lobe_of_layers(
    here: &MovingVertex,
    interface: &Interface<D>,
    layers: &Layers<D>,
    w: V3<D>,
) -> V3<D> {
    let Vertices { kinds, lobes, .. } = *here.vertices;
    let lit = |lit| {
        let (n, direction, kinds) = (here.n, here.direction, kinds.masks());
        layered_evaluate::<D>(n, direction, w, *interface, *layers, kinds, lit)
    };
    let [with, without] = lobes.lit_alone();
    lit(with) - lit(without)
}
