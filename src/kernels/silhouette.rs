//! Where visibility changes: the two functions whose zero sets are the discontinuities seen from a
//! point.

use crate::lanes::{Real, V3};

/// Zero where the ray from `o` along `d` passes through the line of the edge (`a`, `b`).
///
/// Its gradient along `d` is normal to the edge's image; its derivative by the parameters over that
/// gradient is the speed of the silhouette.
pub fn edge_side<F: Real>(o: V3<F>, d: V3<F>, a: V3<F>, b: V3<F>) -> F {
    let oa = a - o;
    let ob = b - o;
    d.dot(oa.cross(ob))
}

/// Zero where the ray from `o` along `d` meets the planes of two triangles at the same distance:
/// where two surfaces pass through each other without a common edge.
pub fn crease_side<F: Real>(o: V3<F>, d: V3<F>, a: [V3<F>; 3], b: [V3<F>; 3]) -> F {
    let ea1 = a[1] - a[0];
    let ea2 = a[2] - a[0];
    let eb1 = b[1] - b[0];
    let eb2 = b[2] - b[0];
    let na = ea1.cross(ea2);
    let nb = eb1.cross(eb2);
    let oa = a[0] - o;
    let ob = b[0] - o;
    na.dot(oa) * nb.dot(d) - nb.dot(ob) * na.dot(d)
}
