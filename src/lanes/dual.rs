//! Dual numbers: a value and its tangent, over any lane type. Kernels that run over them
//! differentiate forward.

use super::{Number, Real};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number and its derivative along one direction.
///
/// Comparisons look at the value alone. At a kink (`abs` at zero, `min` and `max` at a tie) the
/// derivative is that of the branch the value took; the generated adjoints decide ties the same
/// way.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual<R> {
    pub value: R,
    pub tangent: R,
}

impl<R: Real> Dual<R> {
    #[inline(always)]
    pub fn new(value: R, tangent: R) -> Self {
        Self { value, tangent }
    }
}

impl Number for Dual<f64> {
    fn value(self) -> f64 {
        self.value
    }
    fn with_tangent(value: f64, tangent: f64) -> Self {
        Self::new(value, tangent)
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self::new(self.value + o.value, self.tangent + o.tangent)
    }
}
impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self::new(self.value - o.value, self.tangent - o.tangent)
    }
}
impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self::new(
            self.value * o.value,
            self.tangent * o.value + self.value * o.tangent,
        )
    }
}
impl<R: Real> Div for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        Self::new(value, (self.tangent - value * o.tangent) / o.value)
    }
}
impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value, -self.tangent)
    }
}

impl<R: Real> Real for Dual<R> {
    type Mask = R::Mask;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::new(R::splat(value), R::splat(0.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        Self::new(root, self.tangent / (root + root))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let negative = self.value.lt(R::splat(0.0));
        Self::new(
            self.value.abs(),
            R::select(negative, -self.tangent, self.tangent),
        )
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        Self::new(value, self.tangent * value)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        Self::new(self.value.ln(), self.tangent / self.value)
    }
    #[inline(always)]
    fn signum(self) -> Self {
        Self::new(self.value.signum(), R::splat(0.0))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::new(
            self.value.min(other.value),
            R::select(self.value.le(other.value), self.tangent, other.tangent),
        )
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::new(
            self.value.max(other.value),
            R::select(self.value.ge(other.value), self.tangent, other.tangent),
        )
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Self::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> Self::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        self.value.gt(other.value)
    }
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        self.value.ge(other.value)
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            R::select(mask, yes.value, no.value),
            R::select(mask, yes.tangent, no.tangent),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tangent against a central difference, for both arguments moving at their own speed.
    fn check(name: &str, f: fn(Dual<f64>, Dual<f64>) -> Dual<f64>) {
        let at = |a, b| f(Dual::new(a, 0.0), Dual::new(b, 0.0)).value;
        for (a, b) in [(0.7, 1.3), (1.9, 0.4), (0.2, 0.3)] {
            for (speed_a, speed_b) in [(1.0, 0.0), (0.0, 1.0), (0.6, -1.7)] {
                let h = 1e-6;
                let ahead = at(a + h * speed_a, b + h * speed_b);
                let behind = at(a - h * speed_a, b - h * speed_b);
                let want = (ahead - behind) / (2.0 * h);
                let got = f(Dual::new(a, speed_a), Dual::new(b, speed_b));
                assert_eq!(got.value, at(a, b), "{name}({a}, {b})");
                let error = (got.tangent - want).abs();
                assert!(
                    error < 1e-8 * (1.0 + want.abs()),
                    "{name}({a}, {b}): {} is not {want}",
                    got.tangent
                );
            }
        }
    }

    #[test]
    fn tangents_are_derivatives() {
        check("add", |a, b| a + b);
        check("sub", |a, b| a - b);
        check("mul", |a, b| a * b);
        check("div", |a, b| a / b);
        check("neg", |a, _| -a);
        check("sqrt", |a, _| a.sqrt());
        check("abs", |a, b| (a - b).abs());
        check("exp", |a, _| a.exp());
        check("ln", |a, _| a.ln());
        check("signum", |a, b| (a - b).signum());
        check("min", |a, b| a.min(b));
        check("max", |a, b| a.max(b));
        check("select", |a, b| Dual::select(a.lt(b), a * a, b * b));
        check("splat", |_, _| Dual::splat(3.0));
    }

    #[test]
    fn comparisons_look_at_values() {
        let slow = Dual::new(1.0, -5.0);
        let fast = Dual::new(1.0, 5.0);
        assert!(slow.le(fast) && slow.ge(fast) && !slow.lt(fast) && !slow.gt(fast));
    }

    #[test]
    fn an_unselected_nan_stays_out() {
        let bad = Dual::new(f64::NAN, f64::NAN);
        let good = Dual::new(1.0, 2.0);
        assert_eq!(Dual::select(true, good, bad), good);
        assert_eq!(Dual::select(false, bad, good), good);
    }
}
