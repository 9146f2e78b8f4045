//! Normals of triangles and of smooth vertices.

use crate::lanes::{Real, V3};

/// Unit geometric normal, to the side from which the vertices run counter-clockwise.
pub fn face_normal<F: Real>(v0: V3<F>, v1: V3<F>, v2: V3<F>) -> V3<F> {
    let e1 = v1 - v0;
    let e2 = v2 - v0;
    e1.cross(e2).normalize()
}

/// Unit shading normal at barycentrics (1−b1−b2, b1, b2) between three vertex normals.
pub fn shading_normal<F: Real>(n0: V3<F>, n1: V3<F>, n2: V3<F>, b1: F, b2: F) -> V3<F> {
    let sum = n0 * (F::splat(1.0) - b1 - b2) + n1 * b1 + n2 * b2;
    sum.normalize()
}
