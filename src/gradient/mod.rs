//! From stored paths to gradients: forward and backward sweeps, their sums, and standard errors.

mod boundary;
mod light;
pub mod path;
pub mod scene;
pub mod terms;
pub mod warp;
