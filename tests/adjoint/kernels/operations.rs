//! Every operation on numbers, vectors and masks.

use crate::lanes::{Real, V3};
use std::f64::consts::PI;

const HALF: f64 = 0.5;
const THIRD: f64 = 2.0 * HALF / 3.0;

pub fn sum_and_product<F: Real>(a: F, b: F) -> (F, F) {
    (a + b, a * b)
}

pub fn ratio<F: Real>(a: F, b: F) -> F {
    -a / (b - F::splat(3.5))
}

/// Division of and by a constant, and of a number by itself.
pub fn divisions<F: Real>(a: F, b: F) -> F {
    let itself = b;
    F::splat(PI / 4.0) / a + b / F::splat(-THIRD) + a / b + b / itself
}

pub fn logarithm<F: Real>(a: F) -> F {
    (a * a).ln() * a
}

pub fn unary<F: Real>(a: F) -> (F, F, F, F) {
    let x = a - F::splat(0.8);
    (a.sqrt(), x.abs(), (-a).exp(), x.signum() * a)
}

pub fn extremes<F: Real>(a: F, b: F) -> F {
    let low = a.min(b);
    let high = a.max(b);
    low * F::splat(2.0) + high * high + a.min(F::splat(HALF)) + F::splat(0.7).max(b)
}

/// One name bound three times, each built from the one before; a value nobody reads; `t1` and
/// `a_bar` as names, which the transformation would like for itself.
pub fn shadowing<F: Real>(a: F, b: F) -> F {
    let a_bar = a * b;
    let a = a * a_bar + b * b * a;
    let _unused = a.sqrt();
    let _ = b.exp();
    let t1: F = (a + b) * (a - b);
    let a = a * t1;
    let same = a;
    let out_bar = same * a;
    out_bar + a_bar
}

pub fn vectors<F: Real>(a: V3<F>, b: V3<F>, s: F) -> (V3<F>, F) {
    let c = a.cross(b) + a.times(b) * s - -b;
    let d = c * c.length() + a.normalize();
    (d, d.dot(a) + c.x * a.y - c.z)
}

/// A vector used whole and by its components, put together again out of order.
pub fn components<F: Real>(a: V3<F>, k: F) -> V3<F> {
    let y = a.y;
    let turned = V3::new(a.z, a.x * k, y);
    let mixed = turned + a * turned.z;
    V3::new(mixed.x * mixed.y, y, k) + V3::splat(HALF) * k
}

/// Masks from every comparison and connective, as an argument and in a select of vectors.
pub fn masks<F: Real>(a: V3<F>, b: V3<F>, given: F::Mask) -> (V3<F>, F::Mask, F) {
    let m = a.x.lt(b.x) & a.y.le(b.y) | !a.z.gt(b.z);
    let n = given & b.x.ge(F::splat(0.0));
    let v = V3::select(m, a * b.x, b);
    let s = F::select(n | m, a.x * b.y, b.z);
    (v, n, F::select(given, s, s * s))
}

/// The double-where idiom: the root's infinite derivative at a negative number stays out.
///
/// inputs: x -1..1
pub fn guarded_root<F: Real>(x: F) -> F {
    let inside = x.gt(F::splat(0.0));
    let safe = F::select(inside, x, F::splat(1.0));
    F::select(inside, safe.sqrt(), F::splat(0.0))
}

/// A constant argument, and an argument the result does not depend on.
///
/// inputs: -2..2, a 0.5..1
pub fn passive_arguments<F: Real>(a: F, _unread: V3<F>, exponent: f64, flat: F) -> F {
    a.sqrt() * F::splat(exponent * 2.0) + flat.signum()
}

/// Has no adjoint, and can be called all the same.
pub fn is_inside<F: Real>(b1: F, b2: F) -> F::Mask {
    let zero = F::splat(0.0);
    b1.ge(zero) & b2.ge(zero) & (b1 + b2).le(F::splat(1.0))
}

pub fn inside_or_sum<F: Real>(a: F, b: F) -> F {
    F::select(
        is_inside(a, b),
        passive_arguments(a, V3::splat(1.0), HALF, b),
        a * b,
    )
}
