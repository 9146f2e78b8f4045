//! Adjoints of kernels: the engine's, and some that only the tests have.

mod engine;
mod extremes;
mod kernels;
mod operations;
mod support;

// Generated sources name `lanes`, `kernels` and `adjoint` from the root of their crate.
use warpath::lanes;

mod adjoint {
    pub use warpath::adjoint::*;
    include!(concat!(env!("OUT_DIR"), "/test_adjoint/all.rs"));
}
