//! The forward sweep at relays (`paths::relay`).

use crate::gradient::path::forward::{Arriving, D, ForwardSweep, MovingVertex, value_of};
use crate::gradient::scene::forward::{dual_vector, tangent_of};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::{from_lanes, lane_mask, lane_of};
use crate::paths::relayed::{Relay, lanes};
use crate::paths::store::Vertices;
use glam::Vec3;

impl ForwardSweep<'_> {
    /// What it brings that the rays turn that arrive at relays. Those that leave the scene do not
    /// turn any more.
    pub(super) fn turned_rays(
        &self,
        relays: &[Relay],
        vertices: &Vertices,
        chain: &mut Arriving,
    ) -> V3<Lane> {
        if relays.is_empty() {
            return V3::splat(0.0);
        }
        let turned = tangent_of(chain.direction);
        let mut brings = [Vec3::ZERO; LANES];
        for relay in relays {
            let lane = usize::from(relay.lane);
            let turned = lane_of(turned, lane).to_array();
            let terms = relay.by_direction.iter().zip(turned);
            brings[lane] = terms.map(|(by, turned)| by * turned).sum();
        }
        let escaped = lanes(relays) & vertices.escaped;
        chain.direction = moving(chain.direction, escaped, V3::splat(0.0));
        from_lanes(&brings)
    }

    /// What it brings that relays slide over their triangles, and the vertex without that, as the
    /// rest of the path sees it.
    pub(super) fn slid<'v>(
        &self,
        relays: &[Relay],
        here: MovingVertex<'v>,
        chain: &mut Arriving,
    ) -> (V3<Lane>, MovingVertex<'v>) {
        let by_b = here.b.map(|b| b.tangent.to_array());
        let mut brings = [Vec3::ZERO; LANES];
        for relay in relays {
            let lane = usize::from(relay.lane);
            brings[lane] = relay.by_b[0] * by_b[0][lane] + relay.by_b[1] * by_b[1][lane];
        }
        // Rays that move with a point of the triangle meet that point.
        let [p, q, r] = here.corners.map(tangent_of);
        let [b1, b2] = here.b.map(|b| b.value);
        let of_point = p + (q - p) * b1 + (r - p) * b2;
        let hit = lanes(relays) & here.vertices.hit;
        chain.origin = moving(chain.origin, hit, of_point);
        chain.direction = moving(chain.direction, hit, V3::splat(0.0));
        let here = self.moving_vertex(here.vertices, chain);
        (from_lanes(&brings), here)
    }
}

/// The same vector with another tangent in the lanes of `bits`.
fn moving(v: V3<D>, bits: u32, tangent: V3<Lane>) -> V3<D> {
    let tangent = V3::select(lane_mask(bits), tangent, tangent_of(v));
    dual_vector(value_of(v), tangent)
}
