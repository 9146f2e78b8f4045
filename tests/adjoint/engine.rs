//! Every adjoint the build derived from `src/kernels/`, against finite differences and forward
//! mode.

use crate::extremes;
use crate::support::{self, Check};

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
