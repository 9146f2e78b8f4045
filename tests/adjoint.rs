//! Every adjoint the build derived from `src/kernels/`, against finite differences and forward mode.

#[path = "support/extremes.rs"]
mod extremes;
mod support;

// The generated table names these from the root of its crate.
use support::Check;
use warpath::{adjoint, kernels, lanes};

include!(concat!(env!("OUT_DIR"), "/adjoint/check.rs"));

#[test]
fn adjoints_are_derivatives() {
    support::check_all(checks());
}

/// The table's ranges are moderate; surfaces are not.
#[test]
fn adjoints_are_derivatives_at_extremes() {
    extremes::check_all(&checks());
}
