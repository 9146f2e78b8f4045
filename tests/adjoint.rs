//! Every adjoint the build derived from `src/kernels/`, against finite differences and forward mode.

mod support;

// The generated table names these from the root of its crate.
use support::Check;
use warpath::{adjoint, kernels, lanes};

include!(concat!(env!("OUT_DIR"), "/adjoint/check.rs"));

#[test]
fn adjoints_are_derivatives() {
    support::check_all(checks());
}
