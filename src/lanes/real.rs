//! The lane trait: what a kernel may do with a number.

use std::ops::{Add, BitAnd, BitOr, Div, Mul, Neg, Not, Sub};

/// The outcome of a comparison, lane by lane.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// The same answer in every lane.
    fn splat(value: bool) -> Self;
    /// Whether any lane holds.
    fn any(self) -> bool;
}

/// A real number, or several in lanes. Kernels are generic over it and have no branches: they
/// select.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    type Mask: Mask;

    /// The same number in every lane (and no tangent). Rounded to the lane's precision.
    fn splat(value: f64) -> Self;
    fn sqrt(self) -> Self;
    fn abs(self) -> Self;
    fn exp(self) -> Self;
    /// The natural logarithm.
    fn ln(self) -> Self;
    /// −1 where the sign bit is set, else 1; its derivative is zero.
    fn signum(self) -> Self;
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn lt(self, other: Self) -> Self::Mask;
    fn le(self, other: Self) -> Self::Mask;
    fn gt(self, other: Self) -> Self::Mask;
    fn ge(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` holds, else `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
}

/// One number, with a tangent or without.
pub trait Number: Real<Mask = bool> {
    fn value(self) -> f64;
    /// A number without a tangent leaves this one out.
    fn with_tangent(value: f64, tangent: f64) -> Self;
}

impl Number for f64 {
    fn value(self) -> f64 {
        self
    }
    fn with_tangent(value: f64, _: f64) -> Self {
        value
    }
}
