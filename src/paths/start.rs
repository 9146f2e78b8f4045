//! How paths begin, and what they are on their way.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::RayPacket;
use crate::paths::spread::Spread;
use crate::paths::surface::vertex::Surface;
use crate::paths::surface::world_bounce::Drawn;
use crate::trace::Coherence;

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

/// A packet of paths on its way to the next vertex.
pub struct Path {
    pub rays: RayPacket,
    pub coherence: Coherence,
    pub throughput: V3<Lane>,
    /// How it spreads, where an estimator wants to know what moves.
    pub spread: Option<Spread>,
    /// Lanes that move against what they see.
    pub moves: u32,
    /// What is left behind, and the part of the directions that its lobe was drawn from.
    pub previous: Option<(Surface, Lane)>,
    /// Around what the bounce was drawn, if samples move.
    pub drawn: Option<Drawn>,
}
