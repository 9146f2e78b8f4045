//! Layers and grain: bounces carry what the BSDF's value says, and light takes the same way in both
//! directions; kernels in f64.

use common::optics::*;
use glam::{DVec3, dvec3};
use std::f64::consts::FRAC_1_PI;
use warpath::kernels::bsdf::{Interface, KindMasks, LobeMasks, RoughTransmission, bsdf_evaluate};
use warpath::kernels::frame::direction_from_local;
use warpath::kernels::layered::{Layers, LitMasks, layered_evaluate, layered_sample, layered_sent};
use warpath::lanes::V3;

const DIRECTIONS: usize = 16;

fn vector(v: DVec3) -> V3<f64> {
    V3::new(v.x, v.y, v.z)
}

fn dvec3_of(v: V3<f64>) -> DVec3 {
    dvec3(v.x, v.y, v.z)
}

fn interface(alpha: f64, eta: DVec3) -> Interface<f64> {
    Interface {
        reflectance: vector(dvec3(0.7, 0.4, 0.2)),
        second_reflectance: vector(dvec3(0.8, 0.9, 1.0)),
        eta: vector(eta),
        k: vector(dvec3(3.5, 2.4, 2.0)),
        alpha,
    }
}

fn layers(alpha_v: f64, spec_trans: f64) -> Layers<f64> {
    Layers {
        tangent: vector(dvec3(2.0, 0.7, -0.4)),
        alpha_v,
        roughness: 0.5,
        anisotropic: 0.4,
        metallic: 0.3,
        spec_trans,
        spec_tint: 0.35,
        sheen: 0.7,
        sheen_tint: 0.45,
        flatness: 0.25,
        clearcoat: 0.8,
        clearcoat_gloss: 0.1,
    }
}

#[derive(Clone, Copy, PartialEq, Debug)]
enum Kind {
    Metal,
    Glass,
    Layers,
}

fn masks(kind: Kind, is_ggx: bool, is_entering: bool) -> KindMasks<f64> {
    KindMasks {
        is_conductor: kind == Kind::Metal,
        is_plastic: false,
        is_smooth: false,
        is_ggx,
        is_nonlinear: false,
        is_principled: kind == Kind::Layers,
        is_thin: false,
        is_entering,
    }
}

/// Directions over the hemisphere, evenly in height.
fn directions(turn: f64) -> impl Iterator<Item = DVec3> + Clone {
    (0..DIRECTIONS).map(move |k| {
        let z = (k as f64 + 0.3) / DIRECTIONS as f64;
        let (sin, cos) = (turn + 2.4 * k as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        dvec3(radius * cos, radius * sin, z)
    })
}

fn assert_equal(what: &str, a: DVec3, b: DVec3, rounding: f64) {
    let allowed = rounding * (a.abs() + b.abs()) + 1e-30;
    let is_equal = (a - b).abs().cmple(allowed).all();
    assert!(is_equal, "{what}: {a} against {b}");
}

fn about(n: DVec3, local: DVec3) -> DVec3 {
    dvec3_of(direction_from_local(vector(n), vector(local)))
}

/// Every lobe's weight times the density of its coordinate over solid angle adds up to the value.
#[test]
fn bounces_carry_the_value() {
    let n = dvec3(0.3, -0.5, 0.8).normalize();
    let eta = dvec3(1.5, 0.9, 1.3);
    for kind in [Kind::Metal, Kind::Glass, Kind::Layers] {
        for (is_ggx, is_entering) in [(true, true), (false, true), (true, false)] {
            let (s, l) = (interface(0.3, eta), layers(0.6, 0.4));
            let kinds = masks(kind, is_ggx, is_entering);
            let ratio = if is_entering { eta.x } else { 1.0 / eta.x };
            for i in directions(0.0).map(|d| about(n, d)) {
                for o in directions(1.0).flat_map(|d| [d, -d]).map(|d| about(n, d)) {
                    let is_through = o.dot(n) < 0.0;
                    if is_through && kind == Kind::Metal {
                        continue;
                    }
                    let run = |m: DVec3, is_diffuse: bool, is_coat: bool| {
                        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
                        let local = axes.map(|axis| about(n, axis).dot(m));
                        let lobes = LobeMasks {
                            is_diffuse,
                            is_reflected: !is_diffuse && !is_through,
                            is_refracted: is_through,
                            is_coat,
                        };
                        let local = vector(local.into());
                        let (next, weight) =
                            layered_sample(vector(n), vector(-i), local, s, l, lobes, kinds);
                        assert!(dvec3_of(next).distance(o) < 1e-9, "{kind:?}: to {next:?}");
                        dvec3_of(weight)
                    };
                    let mut carried = DVec3::ZERO;
                    if is_through {
                        let h = (i + o * ratio).normalize();
                        let h = h * h.dot(n).signum();
                        let (at_in, at_out) = (i.dot(h), o.dot(h));
                        if at_in > 1e-3 && at_out < -1e-3 {
                            let sum = at_in + ratio * at_out;
                            let jacobian = ratio * ratio * at_out.abs() / (sum * sum);
                            carried = run(h, false, false) * jacobian;
                        }
                    } else {
                        let (h, jacobian) = reflecting(i, o);
                        carried = run(h, false, false) * jacobian;
                        if kind == Kind::Layers && is_entering {
                            carried += run(h, false, true) * jacobian;
                            carried += run(o, true, false) * o.dot(n) * FRAC_1_PI;
                        }
                    }
                    let sent = layered_sent(
                        vector(n),
                        vector(i * -1.7),
                        vector(o * 0.4),
                        s,
                        l,
                        kinds,
                        true,
                    );
                    let what = format!("{kind:?}, {is_ggx}, {is_entering}, {i} and {o}");
                    assert_equal(&what, carried, dvec3_of(sent), 1e-6);
                }
            }
        }
    }
}

/// With the same roughness along the grain and across it metal is what it is without a grain.
#[test]
fn metal_without_a_grain() {
    let n = dvec3(0.3, -0.5, 0.8).normalize();
    let s = interface(0.3, dvec3(0.2, 0.9, 1.3));
    for is_ggx in [true, false] {
        let kinds = masks(Kind::Metal, is_ggx, true);
        for i in directions(0.0).map(|d| about(n, d)) {
            for o in directions(1.0).map(|d| about(n, d)) {
                let lit = LitMasks {
                    has_lobe: true,
                    has_coat: true,
                };
                let [n, i, o] = [n, -i, o].map(vector);
                let l = layers(0.3, 0.0);
                let own = dvec3_of(layered_evaluate(n, i, o, s, l, kinds, lit));
                let none = RoughTransmission::none();
                let plain = dvec3_of(bsdf_evaluate(n, i, o, s, none, kinds, true));
                assert_equal("metal", own, plain, 1e-9);
            }
        }
    }
}

/// f(i, o) = f(o, i) of all that is reflected.
#[test]
fn reflection_is_reciprocal() {
    let (s, l) = (interface(0.3, dvec3(1.5, 0.9, 1.3)), layers(0.6, 0.4));
    let lit = LitMasks {
        has_lobe: true,
        has_coat: true,
    };
    for kind in [Kind::Metal, Kind::Layers] {
        let kinds = masks(kind, true, true);
        for i in directions(0.0) {
            for o in directions(1.0) {
                let value = |i: DVec3, o: DVec3| {
                    let [n, i, o] = [DVec3::Z, -i, o].map(vector);
                    dvec3_of(layered_evaluate(n, i, o, s, l, kinds, lit))
                };
                assert_equal(&format!("{kind:?}"), value(i, o), value(o, i), 1e-9);
            }
        }
    }
}
