//! Ray queries: packets of rays against the scene's triangles, by Embree or by obvhs.
//!
//! [`Accel`] is the only door to either; the crate's `unsafe` code is nearly all in this module.
//! Which width and which [`Coherence`] to use for which rays is measured in `docs/embree.md`, which
//! backend is faster in `docs/backends.md`.

mod accel;
mod backend;
#[cfg(feature = "embree")]
mod embree;
mod error;
#[cfg(feature = "embree")]
mod ffi;
#[cfg(feature = "embree")]
pub mod floor;
pub mod geometry;
mod meshes;
#[cfg(feature = "obvhs")]
mod obvhs;
mod options;
mod packet;
pub mod pattern;
pub mod tightness;

pub use accel::Accel;
pub use backend::{Backend, EmbreeIsa, EmbreeQuality, ObvhsPreset, ObvhsTree};
pub use error::TraceError;
pub use meshes::MeshView;
pub use options::AccelOptions;
pub use packet::{Coherence, Hits, MISS, Rays, all_lanes};

#[cfg(test)]
mod tests;
