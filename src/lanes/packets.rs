//! Eight or sixteen `f32` side by side, over the `wide` crate.
//!
//! `wide` picks its instructions when it is compiled: build for the machine the program runs on.

use super::{Mask, Real};
use std::ops::{BitAnd, BitOr, Not};

/// Eight `f32`: `F32x8::new([f32; 8])` and `to_array` go in and out.
pub type F32x8 = wide::f32x8;
/// Sixteen `f32`: `F32x16::new([f32; 16])` and `to_array` go in and out.
pub type F32x16 = wide::f32x16;

/// How many lanes [`Lane`] has.
#[cfg(target_feature = "avx512f")]
pub const LANES: usize = 16;
/// How many lanes [`Lane`] has.
#[cfg(not(target_feature = "avx512f"))]
pub const LANES: usize = 8;

/// The widest packet this machine computes in one instruction.
#[cfg(target_feature = "avx512f")]
pub type Lane = F32x16;
/// The widest packet this machine computes in one instruction.
#[cfg(not(target_feature = "avx512f"))]
pub type Lane = F32x8;

/// The outcome of comparing packets: all bits of a lane set, or none.
#[derive(Clone, Copy, Debug)]
pub struct PacketMask<P>(P);

macro_rules! packet_real {
    ($packet:ty, $lanes:literal) => {
        impl BitAnd for PacketMask<$packet> {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }
        impl BitOr for PacketMask<$packet> {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }
        impl Not for PacketMask<$packet> {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }
        impl Mask for PacketMask<$packet> {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                let bits = if value { u32::MAX } else { 0 };
                Self(<$packet>::new([f32::from_bits(bits); $lanes]))
            }
            #[inline(always)]
            fn any(self) -> bool {
                self.0.any()
            }
        }
        impl PacketMask<$packet> {
            /// One bit per lane, the first lane lowest.
            #[inline(always)]
            pub fn to_bits(self) -> u32 {
                self.0.to_bitmask()
            }
        }

        impl Real for $packet {
            type Mask = PacketMask<$packet>;

            #[inline(always)]
            fn splat(value: f64) -> Self {
                <$packet>::splat(value as f32)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                <$packet>::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                <$packet>::abs(self)
            }
            #[inline(always)]
            fn exp(self) -> Self {
                <$packet>::exp(self)
            }
            #[inline(always)]
            fn ln(self) -> Self {
                <$packet>::ln(self)
            }
            #[inline(always)]
            fn signum(self) -> Self {
                <$packet>::splat(1.0).copysign(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                <$packet>::min(self, other)
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                <$packet>::max(self, other)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> Self::Mask {
                PacketMask(self.simd_lt(other))
            }
            #[inline(always)]
            fn le(self, other: Self) -> Self::Mask {
                PacketMask(self.simd_le(other))
            }
            #[inline(always)]
            fn gt(self, other: Self) -> Self::Mask {
                PacketMask(self.simd_gt(other))
            }
            #[inline(always)]
            fn ge(self, other: Self) -> Self::Mask {
                PacketMask(self.simd_ge(other))
            }
            #[inline(always)]
            fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
                mask.0.select(yes, no)
            }
        }
    };
}

packet_real!(F32x8, 8);
packet_real!(F32x16, 16);

#[cfg(test)]
mod tests {
    use super::*;

    /// Zeros of both signs, infinities, a NaN and ordinary numbers of both signs.
    const LEFT: [f32; 16] = [
        0.0,
        -0.0,
        1.5,
        -1.5,
        0.25,
        87.0,
        -87.0,
        1e-3,
        -3.0,
        2.0,
        7.5,
        -0.5,
        1.0,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    const RIGHT: [f32; 16] = [
        1.0,
        0.0,
        1.5,
        2.0,
        -0.25,
        3.0,
        3.0,
        1e3,
        -3.5,
        2.5,
        f32::NAN,
        -0.5,
        -0.0,
        1.0,
        1.0,
        2.0,
    ];

    /// A function of two packets, in the form both widths and the scalar share.
    trait Binary {
        fn at<F: Real>(a: F, b: F) -> F;
    }

    macro_rules! binaries {
        ($check:ident: $($name:ident = |$a:ident, $b:ident| $body:expr, $tolerance:expr;)*) => {$(
            struct $name;
            impl Binary for $name {
                #[allow(unused_variables)]
                fn at<F: Real>($a: F, $b: F) -> F {
                    $body
                }
            }
        )*
        #[test]
        fn $check() {
            $(compare::<$name>(stringify!($name), $tolerance);)*
        }};
    }

    fn compare<B: Binary>(name: &str, tolerance: f32) {
        let eight =
            |v: &[f32; 16], half: usize| F32x8::new(std::array::from_fn(|i| v[8 * half + i]));
        let sixteen = B::at(F32x16::new(LEFT), F32x16::new(RIGHT)).to_array();
        for lane in 0..16 {
            let want = B::at(LEFT[lane], RIGHT[lane]);
            let in_eight =
                B::at(eight(&LEFT, lane / 8), eight(&RIGHT, lane / 8)).to_array()[lane % 8];
            for got in [sixteen[lane], in_eight] {
                let same = got == want || (got.is_nan() && want.is_nan());
                let near = (got - want).abs() <= tolerance * want.abs();
                let what = format!("{name}({}, {})", LEFT[lane], RIGHT[lane]);
                assert!(
                    same || near,
                    "{what}: lane {lane} is {got}, the scalar {want}"
                );
                let signed = got.is_nan() || got.is_sign_positive() == want.is_sign_positive();
                assert!(
                    signed || matches!(name, "Minimum" | "Maximum"),
                    "{what}: sign"
                );
            }
        }
    }

    binaries! { packets_compute_what_scalars_do:
        Sum = |a, b| a + b, 0.0;
        Difference = |a, b| a - b, 0.0;
        Product = |a, b| a * b, 0.0;
        Quotient = |a, b| a / b, 0.0;
        Negation = |a, b| -a, 0.0;
        Root = |a, b| a.sqrt(), 0.0;
        Absolute = |a, b| a.abs(), 0.0;
        Exponential = |a, b| a.exp(), 3e-7;
        Sign = |a, b| a.signum(), 0.0;
        Minimum = |a, b| a.min(b), 0.0;
        Maximum = |a, b| a.max(b), 0.0;
        Constant = |a, b| F::splat(0.1), 0.0;
        Less = |a, b| F::select(a.lt(b), a, b), 0.0;
        LessEqual = |a, b| F::select(a.le(b), F::splat(1.0), F::splat(2.0)), 0.0;
        Greater = |a, b| F::select(a.gt(b), F::splat(1.0), F::splat(2.0)), 0.0;
        GreaterEqual = |a, b| F::select(a.ge(b), F::splat(1.0), F::splat(2.0)), 0.0;
        And = |a, b| F::select(a.ge(b) & a.le(b), F::splat(1.0), F::splat(2.0)), 0.0;
        Or = |a, b| F::select(a.gt(b) | a.lt(b), F::splat(1.0), F::splat(2.0)), 0.0;
        Otherwise = |a, b| F::select(!a.ge(b), F::splat(1.0), F::splat(2.0)), 0.0;
        Always = |a, b| F::select(F::Mask::splat(true), a, b), 0.0;
        Never = |a, b| F::select(F::Mask::splat(false), a, b), 0.0;
    }

    #[test]
    fn any_sees_a_single_lane() {
        let mut one = [0.0; 16];
        one[11] = 1.0;
        let mask = F32x16::new(one).gt(F32x16::splat(0.5));
        assert!(mask.any());
        assert_eq!(mask.to_bits(), 1 << 11);
        assert!(!F32x16::new(one).gt(F32x16::splat(1.5)).any());
    }
}
