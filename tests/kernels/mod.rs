//! Kernels that use the whole subset of the adjoint transformation, for tests alone.

pub mod frame;
pub mod operations;
