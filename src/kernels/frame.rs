//! Directions in a surface's own frame.

use crate::lanes::{Real, V3};

/// World direction of the direction `local` about the unit normal `n`.
///
/// The tangents are those of Duff et al., "Building an Orthonormal Basis, Revisited" (2017), which
/// are smooth in `n` on either side of n.z = 0; the derivative turns the direction with the frame.
pub fn direction_from_local<F: Real>(n: V3<F>, local: V3<F>) -> V3<F> {
    let sign = n.z.signum();
    let a = -(F::splat(1.0) / (sign + n.z));
    let b = n.x * n.y * a;
    let one = F::splat(1.0);
    let s = V3::new(one + sign * n.x * n.x * a, sign * b, -(sign * n.x));
    let t = V3::new(b, sign + n.y * n.y * a, -n.y);
    s * local.x + t * local.y + n * local.z
}
