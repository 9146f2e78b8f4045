//! Kernels around directions, and the random numbers of all that surrounds a sample.

use crate::kernels::light::direction_irradiance;
use crate::lanes::{Real, V3};
use crate::paths::dimensions::Branch;
use crate::paths::random::Stream;
use glam::DVec3;

/// A kernel around directions that are drawn: von Mises and Fisher's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LobeKernel {
    /// Concentration, over a sphere.
    pub kappa: f64,
    /// Rough lobes get a kernel if their roughness (alpha) is above this; diffuse ones always do.
    pub least_roughness: f32,
}

/// What auxiliary rays are traced for.
#[derive(Clone, Copy, Debug)]
pub enum Use {
    Film,
    Light,
    Environment,
    Bounce,
}

/// Random numbers for auxiliary rays.
pub fn auxiliary(stream: &Stream, user: Use, depth: u32) -> Stream {
    stream.branch(Branch::Auxiliary, [user as u32, depth, 0])
}

/// Random numbers for kernels.
pub fn kernel_numbers(stream: &Stream, user: Use, depth: u32, twin: u32) -> Stream {
    stream.branch(Branch::Kernel, [user as u32, depth, twin])
}

/// A direction of von Mises and Fisher's distribution around the unit vector `axis`, and κ(1 − cos)
/// of the angle to it. `at` is uniform in the unit square.
pub fn around(axis: DVec3, kappa: f64, at: [f64; 2]) -> (DVec3, f64) {
    // Of 1 − u, which is not zero.
    let left = (1.0 - at[0]) + at[0] * (-2.0 * kappa).exp();
    let exponent = -left.ln();
    let versine = exponent / kappa;
    let sin = (versine * (2.0 - versine)).max(0.0).sqrt();
    let (x, y) = axis.any_orthonormal_pair();
    let (s, c) = (std::f64::consts::TAU * at[1]).sin_cos();
    (
        axis * (1.0 - versine) + x * (sin * c) + y * (sin * s),
        exponent,
    )
}

/// π times the BSDF of a vertex's drawn lobe times the cosine over π, toward the unit vectors `w`:
/// what a bounce is multiplied with per unit of solid angle.
pub fn per_solid_angle<F: Real>(lobe: V3<F>, n: V3<F>, w: V3<F>) -> V3<F> {
    lobe * direction_irradiance(n, w)
}
