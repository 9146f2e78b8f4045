//! The environment map: its radiance, and samples of it.

pub mod distribution;
mod guide;
pub mod map;
pub mod sample;
