//! Rays and triangles.

use crate::lanes::{Real, V3};

/// Where a ray meets a triangle's plane: distance in units of `d`, and the barycentrics of `v1` and
/// `v2`.
///
/// Solves o + t·d = v0 + b1·(v1−v0) + b2·(v2−v0) by Cramer's rule; infinite where the ray is
/// parallel.
pub fn triangle_hit<F: Real>(o: V3<F>, d: V3<F>, v0: V3<F>, v1: V3<F>, v2: V3<F>) -> (F, F, F) {
    let e1 = v1 - v0;
    let e2 = v2 - v0;
    let s = o - v0;
    let p = d.cross(e2);
    let q = s.cross(e1);
    let inv_det = F::splat(1.0) / e1.dot(p);
    let t = e2.dot(q) * inv_det;
    let b1 = s.dot(p) * inv_det;
    let b2 = d.dot(q) * inv_det;
    (t, b1, b2)
}

/// Where a ray meets a triangle's plane.
pub fn triangle_point<F: Real>(o: V3<F>, d: V3<F>, v0: V3<F>, v1: V3<F>, v2: V3<F>) -> V3<F> {
    let n = (v1 - v0).cross(v2 - v0);
    let t = n.dot(v0 - o) / n.dot(d);
    o + d * t
}
