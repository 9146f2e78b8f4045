//! Rough interfaces: the distribution of microfacets and how they hide each other.

use crate::lanes::Real;

/// Density of microfacet normals (per solid angle and projected area) at an angle to the surface's
/// normal of which `cos2` and `sin2` are the squared cosine and sine. Both are given since 1 − cos²
/// loses all digits where roughness is low.
///
/// GGX (Walter et al. 2007, eq. 33) or Beckmann (eq. 25).
///
/// inputs: cos2 0.3..0.9, sin2 0.1..0.7, alpha 0.2..0.9
pub fn ndf<F: Real>(cos2: F, sin2: F, alpha: F, is_ggx: F::Mask) -> F {
    let pi = F::splat(std::f64::consts::PI);
    let alpha2 = alpha * alpha;
    let spread = sin2 + alpha2 * cos2;
    let ggx = alpha2 / (pi * spread * spread);
    let safe = cos2.max(F::splat(1e-6));
    let beckmann = (-(sin2 / (alpha2 * safe))).exp() / (pi * alpha2 * safe * safe);
    F::select(is_ggx, ggx, beckmann)
}

/// The part of the microfacets seen at cosine `cos` that is not hidden by others, over `cos`:
/// finite at the horizon.
///
/// Smith's G₁ for GGX, and Walter et al.'s rational fit (2007, below eq. 27) for Beckmann.
///
/// inputs: cos 0.1..0.9, alpha 0.2..0.9
pub fn smith_g1_over_cos<F: Real>(cos: F, alpha: F, is_ggx: F::Mask) -> F {
    let one = F::splat(1.0);
    let cos2 = cos * cos;
    let sin2 = (one - cos2).max(F::splat(1e-8));
    let ggx = F::splat(2.0) / (cos + (cos2 + alpha * alpha * sin2).sqrt());
    let slope = one / (alpha * sin2.sqrt());
    let a = cos * slope;
    let fit = slope * (F::splat(3.535) + F::splat(2.181) * a)
        / (one + F::splat(2.276) * a + F::splat(2.577) * (a * a));
    let safe = cos.max(F::splat(1e-6));
    let beckmann = F::select(a.lt(F::splat(1.6)), fit, one / safe);
    F::select(is_ggx, ggx, beckmann)
}
