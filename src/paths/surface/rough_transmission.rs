//! How much light a rough dielectric lets through, in all directions together.
//!
//! A rough plastic's diffuse base is lit through its interface. What gets through at an angle is
//! ∫(1 − F)·G₁(o) over the visible normals, o being the refracted direction: no closed form, so it
//! is tabulated over the cosine, with the 64 cosines of Mitsuba's `roughplastic`; so is what comes
//! back from inside, ∫F·G₁(o) with o reflected. Differences of tables give the slopes by roughness
//! and by the index of refraction.

use crate::kernels::bsdf::RoughTransmission;
use crate::kernels::fresnel::fresnel_dielectric;
use crate::kernels::microfacet::smith_g1_over_cos;
use crate::lanes::Real;
use glam::DVec3;

/// Cosines of a table, as in Mitsuba.
const ENTRIES: usize = 64;
/// Sample normals an integral along each of its two coordinates.
const NODES: usize = 32;
/// Relative step in roughness, and in the index of refraction.
const STEP: f64 = 0.01;

/// Transmittance from outside over the cosine, and mean reflectance from inside.
pub struct TransmissionTable {
    outside: [f32; ENTRIES],
    by_alpha: [f32; ENTRIES],
    by_eta: [f32; ENTRIES],
    alpha: f32,
    eta: f32,
    /// [a, b, c] of the mean reflectance a + b·α + c·η.
    pub inner: [f32; 3],
}

/// Both for one roughness and one index inside over outside.
struct Interfaces {
    outside: [f64; ENTRIES],
    inside: f64,
}

impl Interfaces {
    fn new(eta: f64, alpha: f64, is_ggx: bool) -> Self {
        // 2∫R(μ) μ dμ, as Mitsuba's plain mean over the same cosines has it.
        let inside: f64 = (0..ENTRIES)
            .map(cosine)
            .map(|mu| mu * through(mu, 1.0 / eta, alpha, is_ggx, false))
            .sum();
        Self {
            outside: std::array::from_fn(|i| through(cosine(i), eta, alpha, is_ggx, true)),
            inside: 2.0 * inside / ENTRIES as f64,
        }
    }

    /// Slopes from here to `high`, which is `step` away.
    fn slopes(&self, high: &Self, step: f64) -> ([f32; ENTRIES], f32) {
        let slope = |low: f64, high: f64| ((high - low) / step) as f32;
        (
            std::array::from_fn(|i| slope(self.outside[i], high.outside[i])),
            slope(self.inside, high.inside),
        )
    }
}

impl TransmissionTable {
    /// `eta`: index inside over outside.
    pub fn new(eta: f32, alpha: f32, is_ggx: bool) -> Self {
        let (e, a) = (f64::from(eta), f64::from(alpha));
        let of = |eta: f64, alpha: f64| Interfaces::new(eta, alpha, is_ggx);
        let (low, high) = (1.0 - STEP, 1.0 + STEP);
        let (by_alpha, inner_by_alpha) = of(e, a * low).slopes(&of(e, a * high), 2.0 * STEP * a);
        let (by_eta, inner_by_eta) = of(e * low, a).slopes(&of(e * high, a), 2.0 * STEP * e);
        let here = of(e, a);
        let inner = here.inside as f32 - inner_by_alpha * alpha - inner_by_eta * eta;
        Self {
            outside: here.outside.map(|v| v as f32),
            by_alpha,
            by_eta,
            alpha,
            eta,
            inner: [inner, inner_by_alpha, inner_by_eta],
        }
    }

    /// [a, b, c, d] of the transmittance a + b·cos + c·α + d·η about `cos` and the table's
    /// roughness and index.
    pub fn at(&self, cos: f32) -> [f32; 4] {
        let cos = cos.clamp(0.0, 1.0);
        let place = cos * (ENTRIES - 1) as f32;
        let i = (place as usize).min(ENTRIES - 2);
        let part = place - i as f32;
        let mix = |of: &[f32; ENTRIES]| of[i] * (1.0 - part) + of[i + 1] * part;
        let by_cos = (self.outside[i + 1] - self.outside[i]) * (ENTRIES - 1) as f32;
        let (by_alpha, by_eta) = (mix(&self.by_alpha), mix(&self.by_eta));
        let rest = mix(&self.outside) - by_cos * cos;
        [
            rest - by_alpha * self.alpha - by_eta * self.eta,
            by_cos,
            by_alpha,
            by_eta,
        ]
    }
}

impl<F> RoughTransmission<F> {
    /// From what [`TransmissionTable::at`] says of the two ends, and its `inner`.
    pub fn new(into: [F; 4], out: [F; 4], inner: [F; 3]) -> Self {
        let [at_in, by_cos_in, by_alpha_in, by_eta_in] = into;
        let [at_out, by_cos_out, by_alpha_out, by_eta_out] = out;
        let [inner, by_alpha_inner, by_eta_inner] = inner;
        Self {
            at_in,
            by_cos_in,
            by_alpha_in,
            by_eta_in,
            at_out,
            by_cos_out,
            by_alpha_out,
            by_eta_out,
            inner,
            by_alpha_inner,
            by_eta_inner,
        }
    }

    /// The same in other numbers.
    pub fn map<G>(self, to: impl Fn(F) -> G) -> RoughTransmission<G> {
        RoughTransmission::new(
            [self.at_in, self.by_cos_in, self.by_alpha_in, self.by_eta_in].map(&to),
            [
                self.at_out,
                self.by_cos_out,
                self.by_alpha_out,
                self.by_eta_out,
            ]
            .map(&to),
            [self.inner, self.by_alpha_inner, self.by_eta_inner].map(&to),
        )
    }
}

impl<F: Real> RoughTransmission<F> {
    /// Of what is no rough plastic.
    pub fn none() -> Self {
        let zero = F::splat(0.0);
        Self::new([zero; 4], [zero; 4], [zero; 3])
    }
}

fn cosine(i: usize) -> f64 {
    (i as f64 / (ENTRIES - 1) as f64).max(1e-6)
}

/// What a rough interface lets through, or else reflects, of light at cosine `cos`; `ratio` is the
/// index beyond it over that before it.
fn through(cos: f64, ratio: f64, alpha: f64, is_ggx: bool, refracts: bool) -> f64 {
    let wi = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    let mut sum = 0.0;
    for i in 0..NODES {
        for j in 0..NODES {
            let [u, v] = [i, j].map(|k| (k as f64 + 0.5) / NODES as f64);
            let h = crate::paths::surface::microfacet_sample::visible_normal(wi, alpha, [u, v]);
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
                let unhidden = cos_out * smith_g1_over_cos(cos_out, alpha, is_ggx);
                let weight = crate::paths::surface::microfacet_sample::weight(wi, h, alpha, is_ggx);
                sum += share * unhidden * weight;
            }
        }
    }
    sum / (NODES * NODES) as f64
}
