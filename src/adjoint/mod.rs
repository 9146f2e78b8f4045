//! The reverse-mode twins of the kernels, derived from their sources when the crate is built.
//!
//! For a kernel `foo` in `src/kernels/bar.rs` there is `bar::foo_adjoint` here: the same arguments,
//! then the cotangent of the result; it gives the cotangents of the arguments. What a kernel may
//! contain is documented in `src/adjoint/transform/mod.rs`; the generated text is in the build's
//! `OUT_DIR/adjoint/`.

pub mod ops;
// The build runs it; here it is only tested.
#[cfg(test)]
mod transform;

include!(concat!(env!("OUT_DIR"), "/adjoint/all.rs"));
