//! Kernels that use the whole subset of the adjoint transformation, for tests alone.

pub mod operations;
pub mod structs;
pub use warpath::kernels::*;
