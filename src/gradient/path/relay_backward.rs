//! The backward sweep at relays (`paths::relay`).

use crate::adjoint::triangle::triangle_hit_adjoint;
use crate::gradient::path::backward::{BackwardSweep, Returning, Solved};
use crate::gradient::path::bars::VertexBars;
use crate::gradient::scene::backward::TileSums;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked};
use crate::paths::relayed::{Relay, lanes};
use crate::paths::store::TileStore;
use glam::Vec3;

impl BackwardSweep<'_> {
    /// The directions of rays that arrive at relays: what leaves the scene there turns no more.
    pub(super) fn turn(&self, relays: &[Relay], escaped: u32, back: &mut Returning) {
        let mut d_bar = [Vec3::ZERO; LANES];
        for relay in relays {
            let lane = usize::from(relay.lane);
            let bar = lane_of(back.radiance_bar, lane);
            d_bar[lane] = Vec3::from(relay.by_direction.map(|by| by.dot(bar)));
        }
        let kept = masked(!(lanes(relays) & escaped), back.direction);
        back.direction = kept + from_lanes(&d_bar);
    }

    /// Hands what the rest of a path gave to the ray that arrives at a relay to the point of the
    /// triangle that this moves with, and to the ray itself what differences found. Nothing else
    /// has been handed to these rays.
    pub(super) fn slide(
        &self,
        relays: &[Relay],
        here: &Solved,
        back: &mut Returning,
        sums: &mut TileSums,
    ) {
        let vertices = here.vertices;
        let bits = lanes(relays) & vertices.hit;
        let [b1, b2] = here.b;
        let of_point = masked(bits, back.origin);
        let b0 = Lane::splat(1.0) - b1 - b2;
        let mut v_bar = [of_point * b0, of_point * b1, of_point * b2];
        let mut b_bar = [[0.0; LANES]; 2];
        for relay in relays {
            let lane = usize::from(relay.lane);
            let bar = lane_of(back.radiance_bar, lane);
            for (sum, by) in b_bar.iter_mut().zip(relay.by_b) {
                sum[lane] += by.dot(bar);
            }
        }
        let [v0, v1, v2] = here.corners;
        let (o, d) = (vertices.origin, vertices.direction);
        let [b1_bar, b2_bar] = b_bar.map(Lane::new);
        let t_bar = Lane::splat(0.0);
        let (o_bar, d_bar, w0, w1, w2) =
            triangle_hit_adjoint(o, d, v0, v1, v2, (t_bar, b1_bar, b2_bar));
        for (sum, value) in v_bar.iter_mut().zip([w0, w1, w2]) {
            *sum = *sum + masked(bits, value);
        }
        self.scatter(&vertices.triangle, &here.ids, v_bar, bits, sums);
        back.origin = V3::select(lane_mask(bits), o_bar, back.origin);
        back.direction = V3::select(lane_mask(bits), d_bar, back.direction);
    }

    /// What belongs to the arriving ray also at relays: emission and delta lights.
    pub(super) fn arriving(
        &self,
        store: &TileStore,
        (here, before): (&Solved, Option<&Solved>),
        radiance_bar: V3<Lane>,
        (bars, back): (&mut VertexBars, &mut Returning),
        sums: &mut TileSums,
    ) {
        if !self.view.lights.is_empty() {
            self.emission((here, before), radiance_bar, bars, &mut back.earlier, sums);
        }
        self.delta_lights(store, here, radiance_bar, bars, sums);
    }
}
