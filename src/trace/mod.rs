//! Ray queries: packets of rays against the scene's triangles, by Embree.
//!
//! [`Accel`] is the only door to Embree; the crate's `unsafe` code is all in this module. Which width and which
//! [`Coherence`] to use for which rays is measured in `docs/embree.md`.

mod embree;
mod ffi;
pub mod floor;
pub mod geometry;
mod packet;
pub mod tightness;

pub use embree::{Accel, AccelOptions, MeshView, TraceError};
pub use packet::{Coherence, Hits, MISS, Rays, all_lanes};

#[cfg(test)]
mod tests;
