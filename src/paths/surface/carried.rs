//! Which bounces drift with what they meet, and which rest in the world (`paths::lobe_drift`).

use crate::lanes::{LANES, Lane, V3};
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::rays::lane_of;
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::vertex::Surface;

impl SceneView<'_> {
    /// Says which lanes' bounces drift or rest. Returns those whose directions, if they are these,
    /// move against what they see though nothing else does.
    pub fn carry(
        &self,
        drift: &LobeDrift,
        vertices: &mut Vertices,
        (surface, direction): (&Surface, V3<Lane>),
        at_last: bool,
    ) -> u32 {
        let (kinds, lobes) = (vertices.kinds, vertices.lobes);
        let plain = vertices.hit & !kinds.black;
        // They scatter diffusely below, and reflect above.
        let above_paint = kinds.plastic | kinds.principled;
        let mut diffuse = plain & lobes.diffuse & (!kinds.special() | above_paint);
        if at_last {
            // What the last bounces of diffuse lobes find are lights, which have coordinates of
            // their own, and an even sky.
            diffuse = 0;
        }
        if !drift.any_moves() {
            diffuse &= vertices.moves;
        }
        // Rough metal, glass and plastic, whose value is known toward any direction.
        let coat = (kinds.conductor | above_paint) & lobes.reflected;
        let glass = kinds.dielectric & !kinds.grained & (lobes.reflected | lobes.refracted)
            | kinds.transmits & lobes.refracted;
        let rough = plain & (coat | glass) & !(kinds.smooth | kinds.thin);
        let resting = drift.resting_lanes(self.geometry, &vertices.triangle);
        let is_followed = |&lane: &usize| {
            let x = lane_of(surface.x, lane).as_dvec3();
            diffuse >> lane & 1 == 1 && drift.reaches(x, vertices.moves >> lane & 1 == 1)
        };
        let lanes = (0..LANES).filter(is_followed);
        let followed = lanes.fold(0, |bits, lane| bits | 1 << lane);
        diffuse &= resting[0] | followed;
        vertices.drifts = diffuse;
        vertices.rests = resting[0] & diffuse | resting[1] & rough;
        let is_carried = |&lane: &usize| {
            let has = |bits: u32| bits >> lane & 1 == 1;
            let [x, n, d] = [surface.x, surface.n, direction].map(|v| lane_of(v, lane).as_dvec3());
            has(diffuse)
                && drift
                    .field([x, n, d], has(vertices.moves), has(vertices.rests))
                    .is_some()
        };
        (0..LANES)
            .filter(is_carried)
            .fold(0, |bits, l| bits | 1 << l)
    }
}
