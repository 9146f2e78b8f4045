//! Kernels of surfaces at grazing angles and extreme roughness: each derivative alone, against
//! differences and forward mode.
//!
//! What a derivative is compared with is scaled by what its argument must change by for the kernel
//! to change: roughness 0.001 makes lobes that narrow. Differences of fourth order with steps of a
//! thousandth of that have an error of some 1e-12 by truncation; arguments are rounded, and a half
//! vector of grazing directions amplifies it, which leaves 1e-6.

use crate::support::Check;
use glam::{DVec3, dvec3};
use warpath::kernels::frame::direction_from_local;
use warpath::lanes::{Dual, V3};

const STEP: f64 = 1e-3;
const BY_DIFFERENCES: f64 = 1e-6;
/// The same products in another order.
const BY_ORDER: f64 = 1e-9;

const ALPHAS: [f64; 4] = [1e-3, 0.03, 0.3, 1.0];
const COSINES: [f64; 4] = [1e-3, 0.03, 0.4, 0.97];

/// An argument and its scale; a scale of zero is a mask or what is not differentiated.
type Point = Vec<(f64, f64)>;

/// What a mask is for the table of checks.
fn mask(holds: bool) -> (f64, f64) {
    (if holds { 1.0 } else { -1.0 }, 0.0)
}

pub fn check_all(checks: &[Check]) {
    let points = [
        ("microfacet::ndf", densities()),
        ("microfacet::smith_g1_over_cos", unhidden()),
        ("fresnel::fresnel_conductor", conductors()),
        ("fresnel::fresnel_dielectric", dielectrics()),
        ("bsdf::bsdf_evaluate", values()),
        ("bsdf::bsdf_sample", bounces()),
    ];
    let mut failures = Vec::new();
    for (name, points) in points {
        let check = checks.iter().find(|c| c.name == name).expect("a kernel");
        assert!(points.len() >= 16, "{name}: {} points", points.len());
        for point in &points {
            assert_eq!(point.len(), check.ranges.len(), "{name}");
            failures.extend(at(check, point).map(|e| format!("{name}: {e} at {point:?}")));
        }
        println!("{name}: {} points", points.len());
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// All derivatives of all outputs at one point; what is wrong first.
fn at(check: &Check, point: &Point) -> Option<String> {
    let x: Vec<f64> = point.iter().map(|p| p.0).collect();
    let values = (check.primal)(&x);
    let adjoints: Vec<Vec<f64>> = (0..check.outputs)
        .map(|output| {
            let one = |o: usize| if o == output { 1.0 } else { 0.0 };
            (check.adjoint)(&x, &(0..check.outputs).map(one).collect::<Vec<_>>())
        })
        .collect();
    for (argument, &(_, scale)) in point.iter().enumerate().filter(|(_, p)| p.1 > 0.0) {
        let moved = |steps: f64| {
            let mut x = x.clone();
            x[argument] += steps * STEP * scale;
            (check.primal)(&x)
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(moved);
        let tangent = |i: usize| f64::from(i == argument);
        let duals = x.iter().enumerate();
        let duals: Vec<_> = duals.map(|(i, &x)| Dual::new(x, tangent(i))).collect();
        let forward = (check.dual)(&duals);
        for output in 0..check.outputs {
            let difference =
                (a[output] - 8.0 * b[output] + 8.0 * c[output] - d[output]) / (12.0 * STEP * scale);
            let got = adjoints[output][argument];
            let size = values[output].abs() / scale + got.abs();
            let by = |other: f64| (got - other).abs();
            let is_right = by(difference) <= BY_DIFFERENCES * size
                && by(forward[output].tangent) <= BY_ORDER * size;
            if !(is_right && got.is_finite()) {
                let forward = forward[output].tangent;
                return Some(format!(
                    "∂{output}/∂{argument} is {got:e}, {difference:e} by differences, {forward:e} forward, of {size:e}"
                ));
            }
        }
    }
    None
}

fn both() -> [bool; 2] {
    [true, false]
}

fn densities() -> Vec<Point> {
    let mut points = Vec::new();
    for alpha in ALPHAS {
        for tan in [0.0, 0.5, 1.5] {
            let sin2 = (alpha * tan).powi(2) / (1.0 + (alpha * tan).powi(2));
            for ggx in both() {
                let scale = alpha * alpha;
                points.push(vec![
                    (1.0 - sin2, 0.3),
                    (sin2, scale),
                    (alpha, alpha),
                    mask(ggx),
                ]);
            }
        }
    }
    points
}

fn unhidden() -> Vec<Point> {
    let mut points = Vec::new();
    for alpha in ALPHAS {
        for cos in COSINES {
            for ggx in both() {
                points.push(vec![
                    (cos, alpha.max(cos) * (1.0 - cos)),
                    (alpha, alpha),
                    mask(ggx),
                ]);
            }
        }
    }
    points
}

fn conductors() -> Vec<Point> {
    let mut points = Vec::new();
    for cos in COSINES {
        for (eta, k) in [(0.05, 9.0), (0.2, 3.5), (1.5, 0.01), (3.0, 3.0)] {
            points.push(vec![(cos, cos.min(0.1)), (eta, eta), (k, k)]);
        }
        // The default of scenes, and what is close to it: nothing may cancel. And glass as a metal.
        for (eta, k) in [(0.0, 1.0), (1e-4, 1.0), (0.0, 9.0), (1.5, 0.0)] {
            points.push(vec![(cos, cos.min(0.1)), (eta, 0.1), (k, 0.1)]);
        }
    }
    points
}

fn dielectrics() -> Vec<Point> {
    let mut points = Vec::new();
    for ratio in [1.01, 1.5, 4.0] {
        for cos in COSINES {
            points.push(vec![(cos, cos.min(0.1)), (ratio, 0.01 * ratio)]);
            // Just inside and just outside total reflection.
            let critical = (1.0f64 - 1.0 / (ratio * ratio)).sqrt();
            for beside in [1e-3, -1e-3] {
                let scale = 1e-4;
                points.push(vec![(critical + beside, scale), (1.0 / ratio, scale)]);
            }
        }
    }
    points
}

/// A normal, and about it a direction at cosine `cos` and a half vector some roughness away, on the
/// direction's side.
fn geometry(cos: f64, alpha: f64) -> [DVec3; 3] {
    let n = dvec3(0.48, -0.6, 0.64);
    let (s, t) = n.any_orthonormal_pair();
    let i = s * (1.0 - cos * cos).sqrt() + n * cos;
    let h = (n + s * (0.4 * alpha) + t * (0.3 * alpha)).normalize();
    [n, i, h]
}

/// A direction in the kernels' frame of a normal.
fn world(n: DVec3, local: DVec3) -> DVec3 {
    let v = direction_from_local(V3::new(n.x, n.y, n.z), V3::new(local.x, local.y, local.z));
    dvec3(v.x, v.y, v.z)
}

fn scaled(v: DVec3, scale: f64) -> [(f64, f64); 3] {
    v.to_array().map(|x| (x, scale))
}

/// Colours, indices, roughness and transmission.
fn material(alpha: f64) -> Point {
    let mut point: Point = [0.9, 0.8, 0.7, 0.6, 0.5, 0.4].map(|x| (x, x)).to_vec();
    point.extend([1.5, 0.3, 1.2].map(|x| (x, 0.1 * x)));
    point.extend([2.5, 3.0, 0.2].map(|x| (x, x)));
    point.push((alpha, alpha));
    let transmission = [0.4, 0.3, 0.1, 0.07, 0.5, 0.2, 0.1, 0.06, 0.3, 0.1, 0.05];
    point.extend(transmission.map(|x| (x, 1.0)));
    point
}

fn values() -> Vec<Point> {
    let mut points = Vec::new();
    for alpha in ALPHAS {
        for cos in COSINES {
            let [n, i, h] = geometry(cos, alpha);
            let o = h * (2.0 * i.dot(h)) - i;
            let cos_out = n.dot(o);
            if cos_out <= 0.0 {
                continue;
            }
            // i + o, of which h is the direction, is 2 i·h long.
            let scale = (alpha.min(0.3) * i.dot(h)).min(cos).min(cos_out);
            for ggx in both() {
                for conductor in both() {
                    let mut point: Point = scaled(n, scale).to_vec();
                    point.extend(scaled(-i, scale));
                    point.extend(scaled(o, scale));
                    point.extend(material(alpha));
                    // Conductor, plastic, smooth, GGX, nonlinear, thin, principled, entering; and
                    // the lobe is lit.
                    let flags = [
                        conductor, !conductor, false, ggx, true, false, false, true, true,
                    ];
                    point.extend(flags.map(mask));
                    points.push(point);
                }
            }
        }
    }
    points
}

fn bounces() -> Vec<Point> {
    let mut points = Vec::new();
    for alpha in ALPHAS {
        for cos in COSINES {
            let [n, i, h] = geometry(cos, alpha);
            for lobe in [Lobe::Diffuse, Lobe::Metal, Lobe::Gloss, Lobe::In, Lobe::Out] {
                let ratio: f64 = if lobe == Lobe::Out { 1.0 / 1.5 } else { 1.5 };
                let beyond2 = 1.0 - (1.0 - i.dot(h).powi(2)) / (ratio * ratio);
                let refracted = matches!(lobe, Lobe::In | Lobe::Out);
                let o = if refracted {
                    // Not where the slope of the refracted direction has a root's pole.
                    if beyond2 < 0.05 {
                        continue;
                    }
                    h * (i.dot(h) / ratio - beyond2.sqrt()) - i / ratio
                } else {
                    h * (2.0 * i.dot(h)) - i
                };
                let cos_out = n.dot(o) * if refracted { -1.0 } else { 1.0 };
                if cos_out <= 0.0 {
                    continue;
                }
                let scale = 0.3 * alpha.min(cos).min(cos_out).min(beyond2.abs()).min(i.dot(h));
                for ggx in both() {
                    let mut point: Point = scaled(n, scale).to_vec();
                    point.extend(scaled(-i, scale));
                    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|a| world(n, a).dot(h));
                    point.extend(axes.map(|x| (x, scale)));
                    point.extend(material(alpha));
                    let flags = [
                        lobe == Lobe::Diffuse,
                        matches!(lobe, Lobe::Metal | Lobe::Gloss),
                        refracted,
                        false,
                        lobe == Lobe::Metal,
                        matches!(lobe, Lobe::Diffuse | Lobe::Gloss),
                        false,
                        ggx,
                        true,
                        false,
                        false,
                        lobe != Lobe::Out,
                    ];
                    point.extend(flags.map(mask));
                    points.push(point);
                }
            }
        }
    }
    points
}

#[derive(Clone, Copy, PartialEq)]
enum Lobe {
    Diffuse,
    Metal,
    Gloss,
    In,
    Out,
}
