//! Where visibility changes: the two functions whose zero sets are the discontinuities seen from a point.

use crate::lanes::{Real, V3};

/// Zero where the ray from `o` along `d` passes through the line of the edge (`a`, `b`).
///
/// Its gradient along `d` is normal to the edge's image; its derivative by the parameters over that gradient
/// is the speed of the silhouette.
pub fn edge_side<F: Real>(o: V3<F>, d: V3<F>, a: V3<F>, b: V3<F>) -> F {
    let oa = a - o;
    let ob = b - o;
    d.dot(oa.cross(ob))
}

/// Zero where the ray from `o` along `d` meets the planes of two triangles at the same distance: where two
/// surfaces pass through each other without a common edge.
#[allow(clippy::too_many_arguments)] // Two triangles seen along a ray are that many.
pub fn crease_side<F: Real>(
    o: V3<F>,
    d: V3<F>,
    a0: V3<F>,
    a1: V3<F>,
    a2: V3<F>,
    b0: V3<F>,
    b1: V3<F>,
    b2: V3<F>,
) -> F {
    let ea1 = a1 - a0;
    let ea2 = a2 - a0;
    let eb1 = b1 - b0;
    let eb2 = b2 - b0;
    let na = ea1.cross(ea2);
    let nb = eb1.cross(eb2);
    let oa = a0 - o;
    let ob = b0 - o;
    na.dot(oa) * nb.dot(d) - nb.dot(ob) * na.dot(d)
}
