//! How much light an interface reflects.

use crate::lanes::Real;

/// Nothing under a root becomes smaller: its derivative stays finite, and is zero there.
const SMALLEST: f64 = 1e-30;

/// Unpolarised reflectance of a conductor of complex index `eta` + i`k` (relative to the outside)
/// for light at cosine `cos` to the normal.
///
/// It needs the real part `a` of √((eta + i k)² − sin²) = √(t + i·2·eta·k), which is √((|…| +
/// t)/2). Where t < 0, as in most metals, that sum cancels, and wholly so at eta = 0; there `a` is
/// found from the imaginary part √((|…| − t)/2) instead, since the product of the two is eta·k. So
/// `a` has all its digits, and a derivative at eta = 0.
///
/// inputs: cos 0.1..0.9, eta 0.2..2, k 0.5..4
pub fn fresnel_conductor<F: Real>(cos: F, eta: F, k: F) -> F {
    let one = F::splat(1.0);
    let half = F::splat(0.5);
    let two = F::splat(2.0);
    let cos2 = cos * cos;
    let sin2 = one - cos2;
    let t = eta * eta - k * k - sin2;
    let eta_k = two * eta * k;
    let length = (t * t + eta_k * eta_k).max(F::splat(SMALLEST)).sqrt();
    let larger = (half * (length + t.abs())).sqrt();
    let a = F::select(t.lt(F::splat(0.0)), half * eta_k / larger, larger);
    let sum = length + cos2;
    let mixed = two * a * cos;
    let perpendicular = (sum - mixed) / (sum + mixed);
    let long = length * cos2 + sin2 * sin2;
    let cross = mixed * sin2;
    let parallel = perpendicular * ((long - cross) / (long + cross));
    half * (perpendicular + parallel)
}

/// Unpolarised reflectance of a dielectric whose index beyond the interface is `ratio` times that
/// of the side the light comes from, at cosine `cos` to the normal; 1 where all is reflected.
///
/// inputs: cos 0.3..0.9, ratio 1.1..1.8
pub fn fresnel_dielectric<F: Real>(cos: F, ratio: F) -> F {
    let one = F::splat(1.0);
    let sin2 = (one - cos * cos) / (ratio * ratio);
    let passes = sin2.lt(F::splat(0.999999));
    let beyond = F::select(passes, one - sin2, one).sqrt();
    let s = (cos - ratio * beyond) / (cos + ratio * beyond);
    let p = (ratio * cos - beyond) / (ratio * cos + beyond);
    F::select(passes, F::splat(0.5) * (s * s + p * p), one)
}

/// Diffuse light from inside that a smooth interface reflects back, averaged over directions; `eta`
/// > 1 is the index of the inside over that of the outside.
///
/// The fit of Egan & Hilgeman (1973) for 1/eta < 1, as Mitsuba's `plastic` uses it.
///
/// inputs: eta 1.1..1.8
pub fn inner_reflectance<F: Real>(eta: F) -> F {
    let inverse = F::splat(1.0) / eta;
    F::splat(0.6681) + F::splat(0.0636) * eta + F::splat(0.7099) * inverse
        - F::splat(1.4399) * (inverse * inverse)
}
