//! How much light a rough dielectric lets through, in all directions together.
//!
//! A rough plastic's diffuse base is lit through its interface. What gets through at an angle is
//! ∫(1 − F)·G₁(o) over the visible normals, o being the refracted direction: no closed form, so it
//! is tabulated over the cosine, with the 64 cosines of Mitsuba's `roughplastic`. What comes back
//! from inside is ∫F·G₁(o) with o reflected. Differences of both give the slopes by roughness and
//! by the index of refraction.
//!
//! From inside, F turns off sharply where total reflection begins, and a sum over sample normals
//! would jump whenever one of them passes that angle as the index changes. Only F depends on the
//! index there, and only by the cosine to the normal. So the rest is gathered over that cosine
//! once, and F is averaged around each of its places.

use crate::kernels::bsdf::RoughTransmission;
use crate::kernels::fresnel::fresnel_dielectric;
use crate::kernels::microfacet::smith_g1_over_cos;
use crate::lanes::Real;
use crate::paths::surface::microfacet_sample::{visible_normal, weight};
use glam::DVec3;

/// Cosines of a table, as in Mitsuba.
const ENTRIES: usize = 64;
/// Sample normals an integral along each of its two coordinates.
const NODES: usize = 32;
/// Cosines to a normal at which it is known what comes back from inside.
const PLACES: usize = 65;
/// Where F is looked up between two of them.
const AROUND: usize = 64;
/// Steps that fill a square evenly: 1/p and 1/p² for the plastic number p = 1.3247….
const STEP_U: f64 = 0.754_877_666;
const STEP_V: f64 = 0.569_840_291;
/// Relative step in roughness, and in the index of refraction.
const STEP: f64 = 0.03;

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

/// What would come back from inside in all if all of it were reflected, by the cosine to the
/// normals that reflect it: at equal distances from 0 to 1.
struct Inside([f64; PLACES]);

impl Inside {
    fn new(alpha: f64, is_ggx: bool) -> Self {
        let mut places = [0.0; PLACES];
        for (i, mu) in (0..ENTRIES).map(cosine).enumerate() {
            // Of every cosine other normals.
            let shift = [STEP_U, STEP_V].map(|step| (0.5 + i as f64 * step).fract());
            // 2∫R(μ) μ dμ, as Mitsuba's plain mean over the same cosines has it.
            let share = 2.0 * mu / ENTRIES as f64;
            for_each_normal((mu, shift), alpha, is_ggx, |wi, h, weight| {
                let cos_half = wi.dot(h);
                let sent = share * weight * shown(2.0 * cos_half * h.z - wi.z, alpha, is_ggx);
                let place = cos_half.min(1.0) * (PLACES - 1) as f64;
                let below = (place as usize).min(PLACES - 2);
                let part = place - below as f64;
                places[below] += sent * (1.0 - part);
                places[below + 1] += sent * part;
            });
        }
        Self(places)
    }

    /// What does come back.
    fn reflected(&self, eta: f64) -> f64 {
        let step = 1.0 / (PLACES - 1) as f64;
        let mean = |i: usize| {
            let (mut sum, mut all) = (0.0, 0.0);
            for k in 0..2 * AROUND {
                // From one neighbour to the other, the nearer the more.
                let away = (k as f64 + 0.5) / AROUND as f64 - 1.0;
                let cos = (i as f64 + away) * step;
                if (0.0..=1.0).contains(&cos) {
                    sum += (1.0 - away.abs()) * fresnel_dielectric(cos, 1.0 / eta);
                    all += 1.0 - away.abs();
                }
            }
            sum / all
        };
        self.0
            .iter()
            .enumerate()
            .map(|(i, sent)| sent * mean(i))
            .sum()
    }
}

impl Interfaces {
    fn new(eta: f64, alpha: f64, inside: &Inside, is_ggx: bool) -> Self {
        Self {
            outside: std::array::from_fn(|i| transmitted(cosine(i), eta, alpha, is_ggx)),
            inside: inside.reflected(eta),
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
        let factors = [1.0 - STEP, 1.0 + STEP];
        let other = |a: f64| Interfaces::new(e, a, &Inside::new(a, is_ggx), is_ggx);
        let [low, high] = factors.map(|by| other(a * by));
        let (by_alpha, inner_by_alpha) = low.slopes(&high, 2.0 * STEP * a);
        let inside = Inside::new(a, is_ggx);
        let of = |eta: f64| Interfaces::new(eta, a, &inside, is_ggx);
        let [low, high] = factors.map(|by| of(e * by));
        let (by_eta, inner_by_eta) = low.slopes(&high, 2.0 * STEP * e);
        let here = of(e);
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

/// Calls `each` with the direction that light comes from at cosine `cos`, some of the normals that
/// are visible from there, whose lattice stands at `shift` in its cells, and the part that each
/// stands for.
fn for_each_normal(
    (cos, shift): (f64, [f64; 2]),
    alpha: f64,
    is_ggx: bool,
    mut each: impl FnMut(DVec3, DVec3, f64),
) {
    let wi = DVec3::new((1.0 - cos * cos).sqrt(), 0.0, cos);
    for i in 0..NODES {
        for j in 0..NODES {
            let uv = [i as f64 + shift[0], j as f64 + shift[1]].map(|at| at / NODES as f64);
            let h = visible_normal(wi, alpha, uv);
            if wi.dot(h) > 0.0 {
                each(wi, h, weight(wi, h, alpha, is_ggx) / (NODES * NODES) as f64);
            }
        }
    }
}

/// The part of what leaves at this cosine that the interface does not hide; zero below it.
fn shown(cos_out: f64, alpha: f64, is_ggx: bool) -> f64 {
    match cos_out > 0.0 {
        true => cos_out * smith_g1_over_cos(cos_out, alpha, is_ggx),
        false => 0.0,
    }
}

/// What a rough interface lets through of light at cosine `cos`; `ratio` is the index beyond it
/// over that before it.
fn transmitted(cos: f64, ratio: f64, alpha: f64, is_ggx: bool) -> f64 {
    let mut sum = 0.0;
    for_each_normal((cos, [0.5; 2]), alpha, is_ggx, |wi, h, weight| {
        let cos_half = wi.dot(h);
        let beyond = 1.0 - (1.0 - cos_half * cos_half) / (ratio * ratio);
        let o = h * (cos_half / ratio - beyond.max(0.0).sqrt()) - wi / ratio;
        let share = 1.0 - fresnel_dielectric(cos_half, ratio);
        sum += share * weight * shown(-o.z, alpha, is_ggx);
    });
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The slopes are those of what is tabulated, over short steps and long ones.
    #[test]
    fn slopes_are_those_of_the_tables() {
        let inner = |eta: f32, alpha: f32| {
            let [a, b, c] = TransmissionTable::new(eta, alpha, false).inner;
            f64::from(a + b * alpha + c * eta)
        };
        for (eta, alpha) in [(1.44, 0.12), (1.49, 0.2), (1.53, 0.12), (1.6, 0.35)] {
            let [_, by_alpha, by_eta] = TransmissionTable::new(eta, alpha, false).inner;
            for step in [0.002, 0.01] {
                let measured = |high: f64, low: f64| (high - low) / f64::from(2.0 * step);
                let eta_slope = measured(inner(eta + step, alpha), inner(eta - step, alpha));
                let alpha_slope = measured(inner(eta, alpha + step), inner(eta, alpha - step));
                let off = [
                    eta_slope / f64::from(by_eta) - 1.0,
                    alpha_slope / f64::from(by_alpha) - 1.0,
                ];
                let is_right = off.iter().all(|off| off.abs() < 0.01);
                assert!(is_right, "{eta} {alpha} {step}: {off:?}");
            }
        }
    }
}
