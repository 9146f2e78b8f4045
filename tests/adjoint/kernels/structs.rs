//! Structs, arrays, tuples, masks in results, and calls within and across files.

use super::operations::{self, ratio, sum_and_product};
use crate::lanes::{Real, V3};

/// An orthonormal frame.
#[derive(Clone, Copy)]
pub struct Frame<F: Real> {
    pub s: V3<F>,
    pub t: V3<F>,
    pub n: V3<F>,
}

/// A frame and a scale: a struct within a struct.
#[derive(Clone, Copy)]
pub struct Scaled<F: Real> {
    pub frame: Frame<F>,
    pub scale: F,
}

/// A tangent frame around a normal, and where its first construction was used.
pub fn frame<F: Real>(normal: V3<F>) -> (Frame<F>, F::Mask) {
    let n = normal.normalize();
    let first = n.x.abs().gt(n.z.abs());
    let a = V3::new(-n.y, n.x, F::splat(0.0));
    let b = V3::new(F::splat(0.0), -n.z, n.y);
    let s = V3::select(first, a, b).normalize();
    let t = n.cross(s);
    (Frame { s, t, n }, first)
}

/// World to local.
pub fn to_local<F: Real>(frame: Frame<F>, w: V3<F>) -> V3<F> {
    V3::new(frame.s.dot(w), frame.t.dot(w), frame.n.dot(w))
}

/// Calls within the file, a struct taken apart, a part of a call's result that nobody reads.
pub fn local_height<F: Real>(normal: V3<F>, w: V3<F>) -> F {
    let (around, first) = frame(normal);
    let local = to_local(around, w);
    F::select(first, local.x * local.z, local.z)
}

/// Structs built within structs, and a field read back from one just built.
pub fn scaled<F: Real>(frame: Frame<F>, scale: F) -> Scaled<F> {
    let stretched = Frame {
        s: frame.s * scale,
        t: frame.t,
        n: frame.n * (scale + scale),
    };
    Scaled {
        scale: scale * stretched.n.x,
        frame: stretched,
    }
}

/// Calls of another file, by imported name, by module, by full path.
pub fn across_files<F: Real>(a: F, b: F) -> F {
    let (sum, product) = sum_and_product(a, b);
    let r = ratio(sum, product);
    let (_, again) = operations::sum_and_product(r, a);
    crate::kernels::operations::ratio(again, b)
}

/// Arrays in and out, elements used more than once or not at all.
pub fn triangle_parts<F: Real>(v: [V3<F>; 3], weights: [F; 4]) -> [V3<F>; 2] {
    let edge = v[1] - v[0];
    let point = v[0] * weights[0] + v[1] * weights[1] + v[2] * weights[3];
    [edge, point.cross(edge)]
}
