//! Adjoints of kernels that use the whole subset, and what they do at the edges.

use crate::support::{self, Check};
use crate::{adjoint, kernels};

include!(concat!(env!("OUT_DIR"), "/test_adjoint/check.rs"));

#[test]
fn adjoints_are_derivatives() {
    support::check_all(checks());
}

#[test]
fn an_unselected_infinite_derivative_stays_out() {
    assert_eq!(adjoint::operations::guarded_root_adjoint(-0.5, 3.0), 0.0);
    assert_eq!(adjoint::operations::guarded_root_adjoint(0.25, 3.0), 3.0);
}

#[test]
fn no_epsilon_hides_in_a_derivative() {
    let bar = adjoint::operations::unary_adjoint(0.0, (1.0, 0.0, 0.0, 0.0));
    assert_eq!(bar, f64::INFINITY);
}

#[test]
fn ties_are_decided_as_forward_mode_does() {
    let at = |a, b| kernels::operations::extremes(Dual::new(0.6, a), Dual::new(0.6, b)).tangent;
    let bars = adjoint::operations::extremes_adjoint(0.6, 0.6, 1.0);
    assert_eq!(bars, (at(1.0, 0.0), at(0.0, 1.0)));
}
