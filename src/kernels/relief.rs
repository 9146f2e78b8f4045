//! Normals that a picture turns: of normal maps and bump maps, and what the turned surface hides of
//! itself.

use crate::kernels::layered::grain_axes;
use crate::lanes::{Real, V3};

/// The direction of the normal of a bumpy surface, in the frame of the unit normal `n`: along the
/// projection of `du`, across it, and along `n`.
///
/// `du` and `dv` are the derivatives of the position by the texture coordinates, and `rises` (x and
/// y) those of the height above it. How the normal below the bumps turns is left out, as in
/// Mitsuba.
///
/// inputs: n 0.5..0.6, du 0.3..0.9, dv -0.9..-0.3, rises 0.1..0.5
pub fn bump<F: Real>(n: V3<F>, du: V3<F>, dv: V3<F>, rises: V3<F>) -> V3<F> {
    let s = du - n * n.dot(du);
    let t = dv - n * n.dot(dv);
    let area = n.dot(s.cross(t));
    let side = area.signum();
    let along = n.cross(t) * (rises.x * side) + s.cross(n) * (rises.y * side);
    let u = s.normalize();
    let v = n.cross(u);
    V3::new(along.dot(u), along.dot(v), area.abs())
}

/// The unit normal `n` turned to the direction `map` in its frame: along the grain, across it, and
/// along `n`. Where it would look away from the ray that arrives along `direction` the part across
/// `n` is turned round, as Mitsuba does it.
///
/// inputs: n 0.5..0.6, tangent -0.9..-0.3, direction -0.9..-0.3, map 0.1..0.4
pub fn relief_normal<F: Real>(n: V3<F>, tangent: V3<F>, direction: V3<F>, map: V3<F>) -> V3<F> {
    let zero = F::splat(0.0);
    let one = F::splat(1.0);
    let is_some = map.dot(map).gt(F::splat(1e-12));
    let safe = V3::select(is_some, map, V3::new(zero, zero, one)).normalize();
    let axes = grain_axes(n, tangent);
    let across = axes.0 * safe.x + axes.1 * safe.y;
    let along = n * safe.z;
    let wi = -direction;
    let is_away = wi.dot(across + along).le(zero);
    V3::select(is_away, along - across, across + along)
}

/// The part of the light toward or from `w` that a surface of unit normal `n` does not hide from
/// itself where that is turned to the unit normal `turned`; zero where the two look on different
/// sides of `w`.
///
/// Estevez et al., "A Microfacet-Based Shadowing Function to Solve the Bump Terminator Problem"
/// (2019).
///
/// inputs: n 0.5..0.6, turned 0.4..0.7, w 0.3..0.9
pub fn relief_shadow<F: Real>(n: V3<F>, turned: V3<F>, w: V3<F>) -> F {
    let zero = F::splat(0.0);
    let one = F::splat(1.0);
    let wo = w.normalize();
    let cos_w = n.dot(wo);
    let is_seen = (cos_w * turned.dot(wo)).gt(zero);
    let between = n.dot(turned);
    let between2 = (between * between).max(F::splat(1e-6));
    let tan2 = (one - between2).max(zero) / between2;
    let alpha2 = (F::splat(0.125) * tan2).min(one);
    let cos2 = (cos_w * cos_w).max(F::splat(1e-12));
    let spread = cos2 + alpha2 * (one - cos2).max(zero);
    let cos = cos2.sqrt();
    let shown = F::splat(2.0) * cos / (cos + spread.sqrt());
    F::select(is_seen, shown, zero)
}
