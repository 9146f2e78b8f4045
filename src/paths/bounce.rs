//! Where paths go on from a vertex, and what they meet.

use crate::lanes::LANES;
use crate::paths::rays::RayPacket;

/// Where the paths of a packet went on.
#[derive(Clone, Copy)]
pub struct Bounce<'a> {
    pub rays: &'a RayPacket,
    pub seen: BounceEnd<'a>,
}

/// What the bounces of a packet ended on.
#[derive(Clone, Copy)]
pub enum BounceEnd<'a> {
    /// At the last vertex only the environment shines: lanes that see it.
    Environment(u32),
    /// Triangles, or none; the paths go on from there.
    Triangles(&'a [u32; LANES]),
}
