//! Lights of a finite extent, and delta lights: next-event estimation.

pub mod ahead;
pub mod beam;
pub mod delta;
pub mod lamp;
pub mod patches;
pub mod sample;
mod twins;
