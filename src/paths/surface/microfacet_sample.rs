//! Drawing microfacet normals.
//!
//! The visible normals of GGX are reflections of the ray at a spherical cap (Dupuy & Benyoub 2023),
//! which is uniform in the square of its height: no branch, no special case at grazing angles.
//! Beckmann's are drawn from the same with its own roughness: their ratio to GGX's is at most 4/e,
//! so one sampler serves both.

use crate::kernels::microfacet::{ndf, smith_g1_over_cos};
use glam::DVec3;

/// A normal seen from the unit direction `wi` (z up, above the horizon), from two uniform numbers.
pub fn visible_normal(wi: DVec3, alpha: f64, random: [f64; 2]) -> DVec3 {
    visible_normal_of(wi, [alpha; 2], random)
}

/// The same of roughnesses along x and y.
pub fn visible_normal_of(wi: DVec3, [along, across]: [f64; 2], [u, v]: [f64; 2]) -> DVec3 {
    let squeeze = DVec3::new(along, across, 1.0);
    let seen = (wi * squeeze).normalize();
    let z = (1.0 - u) * (1.0 + seen.z) - seen.z;
    let radius = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (v * std::f64::consts::TAU).sin_cos();
    let cap = DVec3::new(radius * cos, radius * sin, z);
    let h = (cap + seen) * squeeze;
    h.try_normalize().unwrap_or(DVec3::Z)
}

/// Density over solid angle of [`visible_normal`].
pub fn pdf_normal(wi: DVec3, h: DVec3, alpha: f64) -> f64 {
    let sin2 = h.x * h.x + h.y * h.y;
    let cos_half = wi.dot(h).max(0.0);
    ndf(h.z * h.z, sin2, alpha, true) * smith_g1_over_cos(wi.z, alpha, true) * cos_half
}

/// D·G₁(ωᵢ)·(ωᵢ·h)/cosθᵢ over the density of [`visible_normal`]: 1 for GGX.
pub fn weight(wi: DVec3, h: DVec3, alpha: f64, is_ggx: bool) -> f64 {
    if is_ggx {
        return 1.0;
    }
    let sin2 = h.x * h.x + h.y * h.y;
    let of =
        |is_ggx: bool| ndf(h.z * h.z, sin2, alpha, is_ggx) * smith_g1_over_cos(wi.z, alpha, is_ggx);
    of(false) / of(true)
}
