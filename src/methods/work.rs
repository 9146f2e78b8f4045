//! About how much work rays are, which is counted and not timed, so that all processes and all runs
//! come to the same.

use super::contender::Contender;
use std::collections::BTreeMap;

/// To make a displaced scene, in microseconds for each vertex that moves: of four it was 0.6 and
/// 2.3 in meshes of 150,000 and 360,000 vertices.
pub const DISPLACED_VERTEX_US: f64 = 0.375;

/// To find a border, beside its rays.
pub const BORDER_US: f64 = 2.5;

/// About the microseconds that rays take with all that is done about them, fitted to the failure
/// battery (`docs/method.md`, 14); that of drawn edges is a guess.
pub fn work(contender: Contender, rays: &BTreeMap<&'static str, u64>, has_map: bool) -> f64 {
    let cost = |kind: &str| match (contender, kind) {
        (Contender::Differences { .. }, "camera") => 0.15,
        (Contender::Differences { .. }, _) => 0.07,
        (Contender::Mixture(_), "camera") => 0.08,
        (Contender::Mixture(_), "shadow") => 0.3,
        (Contender::Mixture(_), "bounce" | "sky_cell") => 0.6,
        (Contender::Mixture(_), "light_cell" | "bounce_cell") => 0.03,
        // Edges that are drawn have to be found first.
        (Contender::Mixture(_), "edge") => 0.8,
        (Contender::Mixture(_), _) => 0.3,
    };
    // To draw from an environment map and to look it up.
    let of_map = |kind: &str| match kind {
        "shadow" | "bounce" | "probe" | "relay" if has_map => 0.5,
        _ => 0.0,
    };
    let rays = rays.iter();
    rays.map(|(kind, n)| (cost(kind) + of_map(kind)) * *n as f64)
        .sum()
}
