//! Light takes the same way in both directions, and bounces carry what the BSDF's value says:
//! kernels in f64.

use super::formulas::*;
use common::optics::*;
use glam::{DVec3, dvec3};
use std::f64::consts::{FRAC_1_PI, PI};
use warpath::kernels::bsdf::{Interface, KindMasks, LobeMasks};
use warpath::kernels::bsdf::{RoughTransmission, bsdf_evaluate, bsdf_sample};
use warpath::kernels::frame::direction_from_local;
use warpath::lanes::V3;
use warpath::scene::Distribution::{self, Beckmann, Ggx};

/// Products of a few dozen rounded factors; what is more is asymmetry.
const ROUNDING: f64 = 1e-11;
/// Twenty directions each way.
const DIRECTIONS: usize = 20;

fn vector(v: DVec3) -> V3<f64> {
    V3::new(v.x, v.y, v.z)
}

fn dvec3_of(v: V3<f64>) -> DVec3 {
    dvec3(v.x, v.y, v.z)
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Kind {
    Metal,
    Plastic,
    Glass,
}

fn interface(kind: Kind, alpha: f64) -> Interface<f64> {
    let (colour, second, eta) = match kind {
        Kind::Metal => (METAL_COLOUR, DVec3::ZERO, METAL_ETA),
        Kind::Plastic => (
            PLASTIC_COLOUR,
            DVec3::splat(PLASTIC_REFLECTS),
            DVec3::splat(ETA),
        ),
        Kind::Glass => (GLASS_REFLECTS, GLASS_TRANSMITS, DVec3::splat(ETA)),
    };
    Interface {
        reflectance: vector(colour),
        second_reflectance: vector(second),
        eta: vector(eta),
        k: vector(METAL_K),
        alpha,
    }
}

/// Some transmission, the same function of the cosine at both ends, of no other meaning.
const THROUGH: RoughTransmission<f64> = RoughTransmission {
    at_in: 0.5,
    by_cos_in: 0.3,
    by_alpha_in: 0.1,
    by_eta_in: 0.05,
    at_out: 0.5,
    by_cos_out: 0.3,
    by_alpha_out: 0.1,
    by_eta_out: 0.05,
    inner: 0.5,
    by_alpha_inner: 0.1,
    by_eta_inner: -0.3,
};

fn masks(kind: Kind, distribution: Distribution, is_entering: bool) -> KindMasks<f64> {
    KindMasks {
        is_conductor: kind == Kind::Metal,
        is_plastic: kind == Kind::Plastic,
        is_smooth: false,
        is_ggx: distribution == Ggx,
        is_nonlinear: true,
        is_principled: false,
        is_thin: false,
        is_entering,
    }
}

/// A direction in the kernels' frame of a normal.
fn world(n: DVec3, local: DVec3) -> DVec3 {
    dvec3_of(direction_from_local(vector(n), vector(local)))
}

/// π times the BSDF, for light from `o` seen from `i`.
fn value(
    kind: Kind,
    s: Interface<f64>,
    distribution: Distribution,
    n: DVec3,
    [i, o]: [DVec3; 2],
) -> DVec3 {
    dvec3_of(bsdf_evaluate(
        vector(n),
        // Directions need not be unit.
        vector(i * -1.7),
        vector(o * 0.4),
        s,
        THROUGH,
        masks(kind, distribution, true),
        true,
    ))
}

#[derive(Clone, Copy, PartialEq)]
enum Lobe {
    Diffuse,
    Reflected,
    Refracted,
}

/// The next direction and the weight, at the coordinate that is the direction `m` in the world.
fn bounce(
    kind: Kind,
    s: Interface<f64>,
    distribution: Distribution,
    [n, i, m]: [DVec3; 3],
    lobe: Lobe,
    is_entering: bool,
) -> (DVec3, DVec3) {
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let local = axes.map(|axis| world(n, axis.into()).dot(m));
    let (next, weight) = bsdf_sample(
        vector(n),
        vector(-i),
        vector(local.into()),
        s,
        THROUGH,
        LobeMasks {
            is_diffuse: lobe == Lobe::Diffuse,
            is_reflected: lobe == Lobe::Reflected,
            is_refracted: lobe == Lobe::Refracted,
            is_coat: false,
        },
        masks(kind, distribution, is_entering),
    );
    (dvec3_of(next), dvec3_of(weight))
}

/// Directions over the hemisphere, evenly in height: to the horizon.
fn directions(turn: f64) -> impl Iterator<Item = DVec3> + Clone {
    (0..DIRECTIONS).map(move |k| {
        let z = (k as f64 + 0.01) / DIRECTIONS as f64;
        let (sin, cos) = (turn + 2.4 * k as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        dvec3(radius * cos, radius * sin, z)
    })
}

/// Every pair of directions, roughness and distribution.
fn for_each_pair(mut each: impl FnMut(DVec3, DVec3, Rough)) {
    for alpha in [0.05, 0.3, 1.0] {
        for distribution in [Ggx, Beckmann] {
            for i in directions(0.0) {
                for o in directions(1.0) {
                    each(
                        i,
                        o,
                        Rough {
                            alpha,
                            distribution,
                        },
                    );
                }
            }
        }
    }
}

fn assert_equal(what: &str, a: DVec3, b: DVec3, rounding: f64) {
    let allowed = rounding * (a.abs() + b.abs()) + 1e-30;
    let is_equal = (a - b).abs().cmple(allowed).all();
    assert!(is_equal, "{what}: {a} against {b}");
}

/// f(i, o) = f(o, i), and both are the formulas'.
#[test]
fn reflection_is_reciprocal() {
    for_each_pair(|i, o, rough| {
        for kind in [Kind::Metal, Kind::Plastic] {
            let s = interface(kind, rough.alpha);
            let what = format!("{rough:?} {kind:?}, {i} and {o}");
            let one = value(kind, s, rough.distribution, DVec3::Z, [i, o]);
            let other = value(kind, s, rough.distribution, DVec3::Z, [o, i]);
            assert_equal(&what, one, other, ROUNDING);
            let through = |cos: f64| 0.5 + 0.3 * cos + 0.1 * rough.alpha + 0.05 * ETA;
            let formula = if kind == Kind::Metal {
                rough.metal(i, o) / o.z
            } else {
                let inner = 0.5 + 0.1 * rough.alpha - 0.3 * ETA;
                let base = base(PLASTIC_COLOUR, inner, true);
                base * through(i.z) * through(o.z) + rough.gloss(i, o) / o.z
            };
            // The kernels keep Beckmann's 1/cos⁴ and what is under roots from zero.
            assert_equal(&what, one, formula * PI, 1e-6);
        }
    });
}

/// Half vectors that refract: f(i, o)·η² = f(o, i), η being the index on o's side over that on i's.
#[test]
fn refraction_is_reciprocal() {
    let n = dvec3(0.3, -0.5, 0.8).normalize();
    let mut compared = 0;
    for alpha in [0.05, 0.3, 1.0] {
        for distribution in [Ggx, Beckmann] {
            for i in directions(0.0) {
                for m in directions(1.0).skip(DIRECTIONS / 3) {
                    let (i, m) = turned(n, [i, m]);
                    let s = interface(Kind::Glass, alpha);
                    let (o, there) = bounce(
                        Kind::Glass,
                        s,
                        distribution,
                        [n, i, m],
                        Lobe::Refracted,
                        true,
                    );
                    if i.dot(m) <= 1e-3 || o.dot(n) >= -1e-6 {
                        continue;
                    }
                    let (again, back) = bounce(
                        Kind::Glass,
                        s,
                        distribution,
                        [-n, o, -m],
                        Lobe::Refracted,
                        false,
                    );
                    assert!(
                        again.distance(i) < 1e-12,
                        "the way back of {i} ends at {again}"
                    );
                    let f = |i: DVec3, o: DVec3, ratio: f64, weight: DVec3| {
                        let (_, jacobian) = refracting_about(i, o, ratio);
                        weight * jacobian / o.dot(n).abs()
                    };
                    let one = f(i, o, ETA, there) * ETA * ETA;
                    let what = format!("roughness {alpha}, {i} and {o}");
                    assert_equal(&what, one, f(o, i, 1.0 / ETA, back), 1e-9);
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 500, "only {compared} pairs");
}

/// The two directions, given about z, about `n`.
fn turned(n: DVec3, of: [DVec3; 2]) -> (DVec3, DVec3) {
    let [i, m] = of.map(|d| world(n, d));
    (i, m)
}

/// As [`refracting`], in any frame.
fn refracting_about(i: DVec3, o: DVec3, ratio: f64) -> (DVec3, f64) {
    let h = (i + o * ratio).normalize();
    let (at_in, at_out) = (i.dot(h), o.dot(h));
    (
        h,
        ratio * ratio * at_out.abs() / (at_in + ratio * at_out).powi(2),
    )
}

/// Weight times density of the coordinate over solid angle is value times cosine: lobe by lobe.
#[test]
fn bounces_carry_the_value() {
    for_each_pair(|i, o, rough| {
        for kind in [Kind::Metal, Kind::Plastic] {
            let s = interface(kind, rough.alpha);
            let what = format!("{rough:?} {kind:?}, {i} and {o}");
            let (h, jacobian) = reflecting(i, o);
            let run =
                |s, m, lobe| bounce(kind, s, rough.distribution, [DVec3::Z, i, m], lobe, true);
            let (next, specular) = run(s, h, Lobe::Reflected);
            assert!(next.distance(o) < 1e-12, "{what}: reflected to {next}");
            let mut carried = specular * jacobian;
            if kind == Kind::Plastic {
                let (next, diffuse) = run(s, o, Lobe::Diffuse);
                assert!(next.distance(o) < 1e-12);
                carried += diffuse * o.z * FRAC_1_PI;
            }
            let value = value(kind, s, rough.distribution, DVec3::Z, [i, o]);
            assert_equal(&what, carried, value * o.z * FRAC_1_PI, 1e-9);
        }
    });
}
