//! How paths begin.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::RayPacket;

/// How a packet of paths begins.
#[derive(Clone, Copy)]
pub struct Start {
    pub rays: RayPacket,
    /// The triangles that these rays meet first, if that is known.
    pub seen: Option<[u32; LANES]>,
    /// Number of the vertex that they lead to; 0 is the first that a camera sees.
    pub depth: u32,
    /// Lanes that move against what they see though nothing but the film drifts.
    pub drifts: u32,
    /// Whether what the first rays find emitting counts.
    pub with_emission: bool,
    /// Whether delta lights count where these end.
    pub with_delta_lights: bool,
    /// Lanes of whose first vertex only the light counts that arrives between two planes
    /// ([`crate::paths::between_planes::BetweenPlanes`]).
    pub between_planes: u32,
    /// Product of weights before them.
    pub throughput: V3<Lane>,
}

impl Start {
    /// With rays that lead to the vertex of this number, where everything counts that they find.
    pub fn of_rays(rays: RayPacket, depth: u32) -> Self {
        Self {
            rays,
            seen: None,
            depth,
            drifts: 0,
            with_emission: true,
            with_delta_lights: true,
            between_planes: 0,
            throughput: V3::splat(1.0),
        }
    }
}
