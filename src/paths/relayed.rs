//! What relays (`paths::relay`) leave for the sweeps.

use glam::Vec3;

/// What a path brings from a relay on, throughput and all, by where and from where it arrives.
#[derive(Clone, Copy, Debug)]
pub struct Relay {
    pub lane: u8,
    /// RGB by the second and the third barycentric coordinate.
    pub by_b: [Vec3; 2],
    /// RGB by each world coordinate of the direction of the ray that arrives.
    pub by_direction: [Vec3; 3],
}

/// The lanes of these.
pub fn lanes(relays: &[Relay]) -> u32 {
    relays.iter().fold(0, |bits, relay| bits | 1 << relay.lane)
}
