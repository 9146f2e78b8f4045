//! The formulas of `docs/mitsuba_conventions.md` again, in other words than the kernels', and
//! integrals over directions.
//!
//! Directions are unit and in the frame of a surface, z along its normal; `i` and `o` point away
//! from it.

use glam::DVec3;
use std::f64::consts::{PI, TAU};
use warpath::scene::Distribution::{self, Beckmann, Ggx};

/// Density D of microfacet normals.
pub fn facets(h: DVec3, alpha: f64, distribution: Distribution) -> f64 {
    if h.z <= 0.0 {
        return 0.0;
    }
    let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
    let part = tan2 / (alpha * alpha);
    let shape = match distribution {
        Ggx => (1.0 + part).powi(-2),
        Beckmann => (-part).exp(),
    };
    shape / (PI * alpha * alpha * h.z.powi(4))
}

/// G₁: the part of the microfacets that is seen along `v`, if they look that way.
pub fn shown(v: DVec3, h: DVec3, alpha: f64, distribution: Distribution) -> f64 {
    if v.dot(h) * v.z <= 0.0 {
        return 0.0;
    }
    let tan = v.x.hypot(v.y) / v.z.abs();
    match distribution {
        Ggx => 2.0 / (1.0 + (alpha * tan).hypot(1.0)),
        Beckmann => {
            let a = 1.0 / (alpha * tan);
            if a >= 1.6 {
                1.0
            } else {
                (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a)
            }
        }
    }
}

/// Reflectance of a dielectric, by the angles on both sides.
pub fn dielectric(cos: f64, ratio: f64) -> f64 {
    let from = cos.clamp(0.0, 1.0).acos();
    let sin = from.sin() / ratio;
    if sin >= 1.0 {
        return 1.0;
    }
    let to = sin.asin();
    if from < 1e-6 {
        return ((1.0 - ratio) / (1.0 + ratio)).powi(2);
    }
    let s = (from - to).sin() / (from + to).sin();
    let p = (from - to).tan() / (from + to).tan();
    (s * s + p * p) / 2.0
}

type Complex = [f64; 2];

fn times(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

/// |a − b|²/|a + b|².
fn contrast(a: Complex, b: Complex) -> f64 {
    let square = |z: Complex| z[0] * z[0] + z[1] * z[1];
    square([a[0] - b[0], a[1] - b[1]]) / square([a[0] + b[0], a[1] + b[1]])
}

/// Reflectance of a conductor: the amplitudes of both polarisations in complex numbers.
pub fn conductor(cos: f64, eta: f64, k: f64) -> f64 {
    let index = [eta, k];
    let square = times(index, index);
    // N·cos of the refracted angle: √(N² − sin²).
    let below = [square[0] - (1.0 - cos * cos), square[1]];
    let length = below[0].hypot(below[1]);
    let root = [
        ((length + below[0]) / 2.0).max(0.0).sqrt(),
        ((length - below[0]) / 2.0).max(0.0).sqrt(),
    ];
    let s = contrast([cos, 0.0], root);
    let p = contrast(times(square, [cos, 0.0]), root);
    (s + p) / 2.0
}

/// Density over solid angle of the normals visible from `i`.
pub fn visible(i: DVec3, h: DVec3, alpha: f64, distribution: Distribution) -> f64 {
    facets(h, alpha, distribution) * shown(i, h, alpha, distribution) * i.dot(h).max(0.0) / i.z
}

/// The normal that reflects `i` to `o`, and dω_h/dω_o.
pub fn reflecting(i: DVec3, o: DVec3) -> (DVec3, f64) {
    let h = (i + o).normalize();
    (h, 0.25 / i.dot(h).abs())
}

/// The normal (above the horizon) that refracts `i` to `o`, and dω_h/dω_o; `ratio` is the index
/// beyond over that on this side.
pub fn refracting(i: DVec3, o: DVec3, ratio: f64) -> Option<(DVec3, f64)> {
    let h = (i + o * ratio).normalize();
    let h = if h.z < 0.0 { -h } else { h };
    let (at_in, at_out) = (i.dot(h), o.dot(h));
    let is_met = at_in > 0.0 && at_out < 0.0;
    let jacobian = ratio * ratio * at_out.abs() / (at_in + ratio * at_out).powi(2);
    is_met.then_some((h, jacobian))
}

/// Where the normal `h` reflects `i` to.
pub fn reflect(i: DVec3, h: DVec3) -> DVec3 {
    h * (2.0 * i.dot(h)) - i
}

/// Where the normal `h` refracts `i` to, if anywhere: by Snell's law along the surface of the
/// microfacet.
pub fn refract(i: DVec3, h: DVec3, ratio: f64) -> Option<DVec3> {
    let along = (h * i.dot(h) - i) / ratio;
    let rest = 1.0 - along.length_squared();
    (rest > 0.0).then(|| along - h * rest.sqrt())
}

/// Coordinates of the unit square on the whole sphere: even in the direction about `axis` within
/// `spread` (half the tangent of the angle), so that bins are as narrow as a lobe.
#[derive(Clone, Copy)]
pub struct Cap {
    axis: DVec3,
    tangents: [DVec3; 2],
    spread2: f64,
}

impl Cap {
    pub fn new(axis: DVec3, spread: f64) -> Self {
        let (x, y) = axis.any_orthonormal_pair();
        Self {
            axis,
            tangents: [x, y],
            spread2: spread * spread,
        }
    }

    /// Where a direction lies.
    pub fn place(&self, d: DVec3) -> [f64; 2] {
        let [x, y] = self.tangents.map(|t| t.dot(d));
        // tan² of half the angle, without loss of digits where that is small.
        let sin2 = x * x + y * y;
        let cos = self.axis.dot(d);
        let tan2 = if cos > 0.0 {
            sin2 / (1.0 + cos).powi(2)
        } else {
            (1.0 - cos) / (1.0 + cos).max(1e-300)
        };
        let turn = (y.atan2(x) / TAU).rem_euclid(1.0);
        [tan2 / (self.spread2 + tan2), turn]
    }

    /// The direction at a place, and dω/dx dy there.
    pub fn direction(&self, [x, y]: [f64; 2]) -> (DVec3, f64) {
        let tan2 = self.spread2 * x / (1.0 - x);
        let cos = (1.0 - tan2) / (1.0 + tan2);
        let sin = 2.0 * tan2.sqrt() / (1.0 + tan2);
        let (s, c) = (y * TAU).sin_cos();
        let [along, across] = self.tangents;
        let d = self.axis * cos + (along * c + across * s) * sin;
        let stretch = (self.spread2 + tan2) / (1.0 + tan2);
        (d, 2.0 * TAU * stretch * stretch / self.spread2)
    }

    /// ∫ f dω over each of `bins`² equal squares, by `nodes`² points in each.
    pub fn integrals(&self, bins: usize, nodes: usize, f: impl Fn(DVec3) -> f64) -> Vec<f64> {
        integrals(bins, nodes, |at| {
            let (d, area) = self.direction(at);
            f(d) * area
        })
    }
}

/// ∫ f over each of `bins`² equal squares of the unit square, by `nodes`² points in each.
pub fn integrals(bins: usize, nodes: usize, f: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
    let all = bins * nodes;
    let mut sums = vec![0.0; bins * bins];
    let middle = |k: usize| (k as f64 + 0.5) / all as f64;
    for i in 0..all {
        for j in 0..all {
            let value = f([middle(i), middle(j)]);
            sums[i / nodes * bins + j / nodes] += value / (all * all) as f64;
        }
    }
    sums
}

/// Coordinates of the unit square on the hemisphere of normals, in which GGX's own density is
/// bounded to the horizon, with dω_h/dx dy.
pub fn normal_at([x, y]: [f64; 2], alpha: f64) -> (DVec3, f64) {
    let tan = alpha * (x * (2.0 - x)).sqrt() / (1.0 - x);
    let (s, c) = (y * TAU).sin_cos();
    let h = DVec3::new(tan * c, tan * s, 1.0).normalize();
    (h, 2.0 * (1.0 - x) / (facets(h, alpha, Ggx) * h.z))
}

/// Where a normal lies in the coordinates of [`normal_at`].
pub fn place_of_normal(h: DVec3, alpha: f64) -> [f64; 2] {
    let tan2 = (h.x * h.x + h.y * h.y) / (h.z * h.z);
    let x = 1.0 - 1.0 / (1.0 + tan2 / (alpha * alpha)).sqrt();
    [x, (h.y.atan2(h.x) / TAU).rem_euclid(1.0)]
}

/// A direction above the horizon at this angle (degrees) to the normal, off the axes of the frame.
pub fn incidence(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (s, c) = 0.7f64.sin_cos();
    DVec3::new(sin * c, sin * s, cos)
}
