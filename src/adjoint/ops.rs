//! The derivatives generated adjoints call, where they take more than an operator.
//!
//! Each gives the cotangent of the argument from that of the result, with no epsilon hidden in it.

use crate::lanes::{Real, V3};

/// What a select can keep or drop: a number or a vector.
pub trait Cotangent<F: Real>: Copy {
    fn choose(mask: F::Mask, yes: Self, no: Self) -> Self;
    fn zero() -> Self;
}

impl<F: Real> Cotangent<F> for F {
    #[inline(always)]
    fn choose(mask: F::Mask, yes: F, no: F) -> F {
        F::select(mask, yes, no)
    }
    #[inline(always)]
    fn zero() -> F {
        F::splat(0.0)
    }
}

impl<F: Real> Cotangent<F> for V3<F> {
    #[inline(always)]
    fn choose(mask: F::Mask, yes: Self, no: Self) -> Self {
        V3::select(mask, yes, no)
    }
    #[inline(always)]
    fn zero() -> Self {
        V3::splat(0.0)
    }
}

/// The cotangent of the side of a select taken where the mask holds: exactly zero elsewhere.
#[inline(always)]
pub fn when<F: Real, C: Cotangent<F>>(mask: F::Mask, bar: C) -> C {
    C::choose(mask, bar, C::zero())
}

/// The cotangent of the side of a select taken where the mask does not hold: exactly zero
/// elsewhere.
#[inline(always)]
pub fn unless<F: Real, C: Cotangent<F>>(mask: F::Mask, bar: C) -> C {
    C::choose(mask, C::zero(), bar)
}

/// From `root = √a`: infinite at zero.
#[inline(always)]
pub fn sqrt_adjoint<F: Real>(root: F, bar: F) -> F {
    bar / (root + root)
}

/// One at zero, as dual numbers have it.
#[inline(always)]
pub fn abs_adjoint<F: Real>(a: F, bar: F) -> F {
    F::select(a.lt(F::splat(0.0)), -bar, bar)
}

/// From `power = eᵃ`.
#[inline(always)]
pub fn exp_adjoint<F: Real>(power: F, bar: F) -> F {
    bar * power
}

/// Infinite at zero.
#[inline(always)]
pub fn ln_adjoint<F: Real>(a: F, bar: F) -> F {
    bar / a
}

/// From `length = |a|`.
#[inline(always)]
pub fn length_adjoint<F: Real>(a: V3<F>, length: F, bar: F) -> V3<F> {
    a * (bar / length)
}

/// From `unit = a / |a|`: what of the cotangent is across it.
#[inline(always)]
pub fn normalize_adjoint<F: Real>(a: V3<F>, unit: V3<F>, bar: V3<F>) -> V3<F> {
    (bar - unit * unit.dot(bar)) * (F::splat(1.0) / a.length())
}
