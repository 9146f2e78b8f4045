//! Light arriving from what emits.

use crate::lanes::{Real, V3};

/// Irradiance over π at `x` with unit normal `n`, for unit radiance from the point (`b1`, `b2`) of
/// the triangle `q`, per unit of db1·db2 and if nothing stands between.
///
/// cosₓ·cos_y/(π r²)·dA with dA = |e1×e2| db1 db2; both cosines are clamped at the horizon. Since
/// the point keeps its barycentrics when the triangle moves, the sharp border of the light never
/// moves in this measure, and no sampling density depends on the parameters.
pub fn triangle_irradiance<F: Real>(x: V3<F>, n: V3<F>, q: [V3<F>; 3], b1: F, b2: F) -> F {
    let e1 = q[1] - q[0];
    let e2 = q[2] - q[0];
    let w = q[0] + e1 * b1 + e2 * b2 - x;
    let zero = F::splat(0.0);
    let cos_x = n.dot(w).max(zero);
    let cos_light = (-(e1.cross(e2).dot(w))).max(zero);
    let r2 = w.dot(w);
    cos_x * cos_light / (r2 * r2 * F::splat(std::f64::consts::PI))
}

/// Irradiance over π at `x` with unit normal `n`, from a point at `p` of unit intensity.
///
/// inputs: x -1..-0.5, n 0.3..0.9, p 0.5..1
pub fn point_irradiance<F: Real>(x: V3<F>, n: V3<F>, p: V3<F>) -> F {
    let w = p - x;
    let r2 = w.dot(w);
    let cos = n.dot(w).max(F::splat(0.0));
    cos / (r2 * r2.sqrt() * F::splat(std::f64::consts::PI))
}

/// Irradiance across the beam at `x`, from a point at `p` of unit intensity.
///
/// inputs: x -1..-0.5, p 0.5..1
pub fn point_falloff<F: Real>(x: V3<F>, p: V3<F>) -> F {
    let w = p - x;
    F::splat(1.0) / w.dot(w)
}

/// Irradiance over π with unit normal `n`, of light whose beam comes from the unit direction `w`.
///
/// inputs: 0.3..0.9
pub fn direction_irradiance<F: Real>(n: V3<F>, w: V3<F>) -> F {
    n.dot(w).max(F::splat(0.0)) * F::splat(std::f64::consts::FRAC_1_PI)
}
