//! BSDF times cosine of the materials of `common::materials`, by the formulas of
//! `docs/mitsuba_conventions.md`.

use common::optics::*;
use glam::{DVec3, dvec3};
use std::f64::consts::FRAC_1_PI;
use warpath::scene::Distribution;

pub const METAL_ETA: DVec3 = dvec3(0.2, 0.9, 1.3);
pub const METAL_K: DVec3 = dvec3(3.5, 2.4, 2.0);
pub const METAL_COLOUR: DVec3 = dvec3(0.9, 0.8, 0.95);
pub const GLASS_REFLECTS: DVec3 = dvec3(0.9, 0.9, 0.9);
pub const GLASS_TRANSMITS: DVec3 = dvec3(0.8, 0.9, 1.0);
pub const PLASTIC_COLOUR: DVec3 = dvec3(0.6, 0.3, 0.2);
pub const PLASTIC_REFLECTS: f64 = 0.9;
/// Of glass and plastic.
pub const ETA: f64 = 1.5;

/// A distribution of microfacets.
#[derive(Clone, Copy, Debug)]
pub struct Rough {
    pub alpha: f64,
    pub distribution: Distribution,
}

impl Rough {
    pub fn new(alpha: f32, distribution: Distribution) -> Self {
        Self {
            alpha: alpha.into(),
            distribution,
        }
    }

    /// D·G₁(i)·G₁(o).
    fn shape(&self, i: DVec3, o: DVec3, h: DVec3) -> f64 {
        let shown = |v: DVec3| shown(v, h, self.alpha, self.distribution);
        facets(h, self.alpha, self.distribution) * shown(i) * shown(o)
    }

    /// D·G/(4cᵢ) and the cosine at the microfacet; zero below the horizon.
    fn reflection(&self, i: DVec3, o: DVec3) -> (f64, f64) {
        let h = (i + o).normalize();
        if o.z <= 0.0 {
            return (0.0, 1.0);
        }
        (self.shape(i, o, h) / (4.0 * i.z), i.dot(h))
    }

    pub fn metal(&self, i: DVec3, o: DVec3) -> DVec3 {
        let (shape, cos) = self.reflection(i, o);
        let reflected = [0, 1, 2].map(|c| conductor(cos, METAL_ETA[c], METAL_K[c]));
        METAL_COLOUR * DVec3::from(reflected) * shape
    }

    /// What a plastic's interface reflects.
    pub fn gloss(&self, i: DVec3, o: DVec3) -> f64 {
        let (shape, cos) = self.reflection(i, o);
        PLASTIC_REFLECTS * dielectric(cos, ETA) * shape
    }

    /// Reflection (`o` above the horizon) and transmission of glass; `ratio` is the index beyond
    /// over that on the side of `i`.
    pub fn glass(&self, i: DVec3, o: DVec3, ratio: f64) -> DVec3 {
        if o.z > 0.0 {
            let (shape, cos) = self.reflection(i, o);
            return GLASS_REFLECTS * dielectric(cos, ratio) * shape;
        }
        let Some((h, _)) = refracting(i, o, ratio) else {
            return DVec3::ZERO;
        };
        let (at_in, at_out) = (i.dot(h), o.dot(h));
        let squeezed = (1.0 - dielectric(at_in, ratio)) / (ratio * ratio);
        let sum = at_in + ratio * at_out;
        let bent = ratio * ratio * (at_in * at_out).abs() / (i.z * sum * sum);
        GLASS_TRANSMITS * squeezed * self.shape(i, o, h) * bent
    }

    /// What the interface lets through from outside, all directions together.
    pub fn through(&self, cos: f64) -> f64 {
        self.mean(cos, |i, h| {
            let o = refract(i, h, ETA).filter(|o| o.z < 0.0);
            o.map_or(0.0, |o| {
                (1.0 - dielectric(i.dot(h), ETA)) * shown(o, h, self.alpha, self.distribution)
            })
        })
    }

    /// What it reflects from inside, in the plain mean over 64 cosines.
    fn back_inside(&self) -> f64 {
        let one = |j: usize| {
            let cos = (j as f64 / 63.0).max(1e-6);
            cos * self.mean(cos, |i, h| {
                let o = reflect(i, h);
                if o.z <= 0.0 {
                    return 0.0;
                }
                dielectric(i.dot(h), 1.0 / ETA) * shown(o, h, self.alpha, self.distribution)
            })
        };
        (0..64).map(one).sum::<f64>() / 32.0
    }

    /// The mean of `f` over the normals seen at cosine `cos`.
    fn mean(&self, cos: f64, f: impl Fn(DVec3, DVec3) -> f64) -> f64 {
        let i = dvec3((1.0 - cos * cos).sqrt(), 0.0, cos);
        let sums = integrals(1, 100, |at| {
            let (h, area) = normal_at(at, self.alpha);
            f(i, h) * visible(i, h, self.alpha, self.distribution) * area
        });
        sums[0]
    }

    /// What a plastic's base reflects, over T(i)·T(o)·cₒ.
    pub fn base(&self, colour: DVec3, is_nonlinear: bool) -> DVec3 {
        base(colour, self.back_inside(), is_nonlinear)
    }
}

/// d/(π η² (1 − r·R)).
pub fn base(colour: DVec3, back: f64, is_nonlinear: bool) -> DVec3 {
    let again = if is_nonlinear { colour } else { DVec3::ONE };
    colour * FRAC_1_PI / (ETA * ETA) / (DVec3::ONE - again * back)
}

/// The fit of what a smooth interface reflects from inside.
pub fn smooth_back_inside() -> f64 {
    let e = 1.0 / ETA;
    0.0636 / e + e * (0.7099 - 1.4399 * e) + 0.6681
}
