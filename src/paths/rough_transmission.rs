//! How much light a rough dielectric lets through, in all directions together.
//!
//! A rough plastic's diffuse base is lit through its interface. What gets through at an angle is ∫(1 − F)·G₁(o) over
//! the visible normals, o being the refracted direction: no closed form, so it is tabulated over the cosine, with the 64
//! cosines of Mitsuba's `roughplastic`; so is what comes back from inside, ∫F·G₁(o) with o reflected. Differences of
//! three tables give the slope by roughness.

use crate::kernels::fresnel::fresnel_dielectric;
use crate::kernels::microfacet::unhidden_over_cos;
use glam::DVec3;

/// Cosines of a table, as in Mitsuba.
const ENTRIES: usize = 64;
/// Sample normals an integral along each of its two coordinates.
const NODES: usize = 32;
/// Relative step in roughness.
const STEP: f64 = 0.01;

/// Transmittance from outside over the cosine, and mean reflectance from inside.
pub struct TransmissionTable {
    value: [f32; ENTRIES],
    by_alpha: [f32; ENTRIES],
    alpha: f32,
    /// At roughness 0 if it went on as at the present one: to be added to `inner_by_alpha`·α.
    pub inner: f32,
    pub inner_by_alpha: f32,
}

impl TransmissionTable {
    /// `eta`: index inside over outside.
    pub fn new(eta: f32, alpha: f32, is_ggx: bool) -> Self {
        let (eta, at) = (eta as f64, alpha as f64);
        let outside = |alpha: f64| -> [f64; ENTRIES] {
            std::array::from_fn(|i| through(cosine(i), eta, alpha, is_ggx, true))
        };
        let inside = |alpha: f64| -> f64 {
            // 2∫R(μ) μ dμ, as Mitsuba's plain mean over the same cosines has it.
            let all = (0..ENTRIES).map(cosine);
            let sum: f64 = all
                .map(|mu| mu * through(mu, 1.0 / eta, alpha, is_ggx, false))
                .sum();
            2.0 * sum / ENTRIES as f64
        };
        let step = STEP * at;
        let slope = |low: f64, high: f64| ((high - low) / (2.0 * step)) as f32;
        let (low, high) = (outside(at - step), outside(at + step));
        let by_alpha: [f32; ENTRIES] = std::array::from_fn(|i| slope(low[i], high[i]));
        let inner_by_alpha = slope(inside(at - step), inside(at + step));
        Self {
            value: outside(at).map(|v| v as f32),
            by_alpha,
            alpha,
            inner: inside(at) as f32 - inner_by_alpha * alpha,
            inner_by_alpha,
        }
    }

    /// [a, b, c] of the transmittance a + b·cos + c·α about `cos` and the table's roughness.
    pub fn at(&self, cos: f32) -> [f32; 3] {
        let cos = cos.clamp(0.0, 1.0);
        let place = cos * (ENTRIES - 1) as f32;
        let i = (place as usize).min(ENTRIES - 2);
        let part = place - i as f32;
        let mix = |of: &[f32; ENTRIES]| of[i] * (1.0 - part) + of[i + 1] * part;
        let by_cos = (self.value[i + 1] - self.value[i]) * (ENTRIES - 1) as f32;
        let by_alpha = mix(&self.by_alpha);
        [
            mix(&self.value) - by_cos * cos - by_alpha * self.alpha,
            by_cos,
            by_alpha,
        ]
    }
}

fn cosine(i: usize) -> f64 {
    (i as f64 / (ENTRIES - 1) as f64).max(1e-6)
}

/// What a rough interface lets through, or else reflects, of light at cosine `cos`; `ratio` is the index beyond it over
/// that before it.
fn through(cos: f64, ratio: f64, alpha: f64, is_ggx: bool, refracts: bool) -> f64 {
    let wi = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..NODES {
        for j in 0..NODES {
            let [u, v] = [i, j].map(|k| (k as f64 + 0.5) / NODES as f64);
            let h = super::microfacets::visible_normal(wi, alpha, [u, v]);
            let cos_half = wi.dot(h);
            if cos_half <= 0.0 {
                continue;
            }
            let reflected = fresnel_dielectric(cos_half, ratio);
            let (share, cos_out) = if refracts {
                let beyond = 1.0 - (1.0 - cos_half * cos_half) / (ratio * ratio);
                let o = h * (cos_half / ratio - beyond.max(0.0).sqrt()) - wi / ratio;
                (1.0 - reflected, -o.z)
            } else {
                (reflected, 2.0 * cos_half * h.z - wi.z)
            };
            if cos_out > 0.0 {
                let unhidden = cos_out * unhidden_over_cos(cos_out, alpha, is_ggx);
                let weight = super::microfacets::weight(wi, h, alpha, is_ggx);
                sum += share * unhidden * weight;
            }
        }
    }
    sum / (NODES * NODES) as f64
}
