//! What both methods need.

use crate::lanes::{Lane, Real, V3};
use crate::paths::at::At;

/// Two independent numbers of a normal distribution, from two of the unit square.
pub fn gaussian([x, y]: [f64; 2]) -> [f64; 2] {
    let radius = (-2.0 * (1.0 - x).ln()).sqrt();
    let (sin, cos) = (std::f64::consts::TAU * y).sin_cos();
    [radius * cos, radius * sin]
}

/// The directions (unit) of a vertex's light samples, and the lanes that see theirs.
pub fn light_directions(at: &At) -> (V3<Lane>, u32) {
    let light = &at.vertices.light;
    let (s, r) = (light.s.to_array(), light.r.to_array());
    let y = at.view.patch_points(&light.patch, &s, &r);
    let seen = light.weight.gt(Lane::splat(0.0)).to_bits();
    ((y - at.surface.x).normalize(), seen)
}
