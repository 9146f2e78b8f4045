//! Ray queries: packets of rays against the scene's triangles, by Embree.
//!
//! [`Accel`] is the only door to Embree; everything `unsafe` is in `embree.rs`. Which width and which
//! [`Coherence`] to use for which rays is measured in `docs/embree.md`.

mod embree;
pub mod geometry;
mod packet;

pub use embree::{Accel, AccelOptions, MeshView, TraceError};
pub use packet::{Coherence, Hits, MISS, Rays, all_lanes};

#[cfg(test)]
mod tests;
