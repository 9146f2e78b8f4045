//! The environment map: its radiance, and samples of it.

pub mod distribution;
pub mod map;
pub mod sample;
