//! The sweeps over samples that move (`paths::warp`): their velocities and scores.

pub mod backward;
pub mod forward;
