//! White furnaces: bounces carry as much as the BSDF reflects and transmits, and never more than
//! arrives.

use super::formulas::*;
use common::materials::Paint;
use common::optics::*;
use common::statistics::Estimate;
use common::swatch::{Bounce, Swatch, bare, with, with_facets};
use glam::DVec3;
use std::f64::consts::TAU;
use warpath::scene::Distribution::{self, Beckmann, Ggx};

const DEGREES: [f64; 4] = [1.0, 45.0, 70.0, 85.0];
/// Independent streams of stratified points.
const STREAMS: u32 = 32;
const POINTS: u32 = 1 << 10;
/// Of 32 means, this many standard errors are met by chance once in 10⁵ times (Student's t, 31
/// degrees of freedom); there are some 400 numbers.
const SIGMAS: f64 = 5.3;
/// What quadrature and single precision leave. Of rough plastics also the tables' interpolation.
const ROUNDING: f64 = 5e-4;
const TABLES: f64 = 3e-3;
/// Of integrals over directions along each of two coordinates.
const NODES: usize = 400;

/// The mean weight of bounces seen from `i`, each counted `times`, for every channel.
fn carried(swatch: &Swatch, times: impl Fn(&Bounce) -> f64) -> [[Estimate; 3]; 4] {
    let mut sums = [[[0.0; STREAMS as usize]; 3]; 4];
    swatch.bounces(
        &DEGREES.map(incidence),
        STREAMS,
        POINTS,
        |stream, lane, b| {
            for (c, sum) in sums[lane].iter_mut().enumerate() {
                sum[stream] += f64::from(b.weight[c]) * times(&b) / f64::from(POINTS);
            }
        },
    );
    sums.map(|lane| lane.map(|channel| Estimate::mean(&channel)))
}

fn compare(what: &str, swatch: &Swatch, bias: f64, wanted: impl Fn(DVec3) -> DVec3) {
    let all = carried(swatch, |_| 1.0);
    for (degrees, carried) in DEGREES.iter().zip(all) {
        let wanted = wanted(incidence(*degrees)).to_array();
        for (carried, wanted) in carried.iter().zip(wanted) {
            let allowed = SIGMAS * carried.error + bias * wanted;
            let is_equal = (carried.value - wanted).abs() <= allowed;
            println!("{what} at {degrees}°: {carried:?}, BSDF {wanted:.5}");
            assert!(
                is_equal,
                "{what} at {degrees}°: bounces carry {carried:?}, the BSDF {wanted}"
            );
        }
    }
}

/// ∫ f over directions, of a lobe of width `spread` about `axis`.
fn over_directions(axis: DVec3, spread: f64, f: impl Fn(DVec3) -> DVec3) -> DVec3 {
    let cap = Cap::new(axis, spread);
    let middle = |k: usize| (k as f64 + 0.5) / NODES as f64;
    let places = (0..NODES * NODES).map(|k| [middle(k / NODES), middle(k % NODES)]);
    let sum = places.map(|at| {
        let (o, area) = cap.direction(at);
        f(o) * area
    });
    sum.sum::<DVec3>() / (NODES * NODES) as f64
}

fn facets() -> impl Iterator<Item = (f32, Distribution)> {
    [
        (0.05, Ggx),
        (0.3, Ggx),
        (1.0, Ggx),
        (0.1, Beckmann),
        (0.5, Beckmann),
    ]
    .into_iter()
}

#[test]
fn diffuse_surfaces_reflect_their_colour() {
    let swatch = Swatch::new(bare(), false);
    compare("diffuse", &swatch, 1e-6, |_| DVec3::new(0.7, 0.5, 0.3));
}

#[test]
fn metal_reflects_what_its_bsdf_says() {
    for (alpha, distribution) in facets() {
        let swatch = Swatch::new(bare().metal("floor", alpha, distribution), false);
        let rough = Rough::new(alpha, distribution);
        compare(&format!("{rough:?} metal"), &swatch, ROUNDING, |i| {
            over_directions(reflect(i, DVec3::Z), rough.alpha, |o| rough.metal(i, o))
        });
    }
    let smooth = with_facets(bare().metal("floor", 0.1, Ggx), None);
    compare("smooth metal", &Swatch::new(smooth, false), ROUNDING, |i| {
        METAL_COLOUR * DVec3::from([0, 1, 2].map(|c| conductor(i.z, METAL_ETA[c], METAL_K[c])))
    });
}

/// "none" reflects everything; what rough facets of it do not, they hide from each other.
#[test]
fn mirrors_reflect_everything() {
    let mirror = |alpha, distribution| {
        let slots = [
            ("eta", [0.0; 3]),
            ("k", [1.0; 3]),
            ("specular_reflectance", [1.0; 3]),
        ];
        with(bare().metal("floor", alpha, distribution), &slots)
    };
    for scene in [
        with_facets(mirror(0.1, Ggx), None),
        mirror(1e-3, Ggx),
        mirror(1e-3, Beckmann),
    ] {
        for carried in carried(&Swatch::new(scene, false), |_| 1.0).as_flattened() {
            assert!((carried.value - 1.0).abs() < 1e-4, "{carried:?}");
        }
    }
    for (alpha, distribution) in facets() {
        for carried in
            carried(&Swatch::new(mirror(alpha, distribution), false), |_| 1.0).as_flattened()
        {
            assert!(carried.value <= 1.0 + SIGMAS * carried.error, "{carried:?}");
        }
    }
}

#[test]
fn glass_carries_what_its_bsdf_says() {
    for (alpha, distribution) in facets() {
        for inside in [false, true] {
            let scene = with_facets(bare().glass("floor", alpha), Some(distribution));
            let swatch = Swatch::new(scene, inside);
            let rough = Rough::new(alpha, distribution);
            let ratio = if inside { 1.0 / ETA } else { ETA };
            let what = format!("{rough:?} glass, inside: {inside}");
            compare(&what, &swatch, 4.0 * ROUNDING, |i| {
                let along = DVec3::new(-i.x, -i.y, 0.0).normalize();
                let below = refract(i, DVec3::Z, ratio).unwrap_or(along);
                let side = |sign: f64| {
                    move |o: DVec3| {
                        let is_there = o.z * sign > 0.0;
                        if is_there {
                            rough.glass(i, o, ratio)
                        } else {
                            DVec3::ZERO
                        }
                    }
                };
                over_directions(reflect(i, DVec3::Z), rough.alpha, side(1.0))
                    + over_directions(below, rough.alpha / 2.0, side(-1.0))
            });
        }
    }
}

/// Radiance that crosses is squeezed by η²: without that, white glass keeps all light if it is
/// smooth.
#[test]
fn smooth_glass_keeps_all_light() {
    let white = [
        ("specular_reflectance", [1.0; 3]),
        ("specular_transmittance", [1.0; 3]),
    ];
    for (inside, ratio) in [(false, ETA), (true, 1.0 / ETA)] {
        let glass = with(bare().glass("floor", 0.3), &white);
        let unsqueezed = |b: &Bounce| {
            if b.lobes.refracted == 1 {
                ratio * ratio
            } else {
                1.0
            }
        };
        let smooth = Swatch::new(with_facets(glass.clone(), None), inside);
        for carried in carried(&smooth, unsqueezed).as_flattened() {
            assert!((carried.value - 1.0).abs() < 1e-5, "{carried:?}");
        }
        for carried in carried(&Swatch::new(glass, inside), unsqueezed).as_flattened() {
            assert!(carried.value <= 1.0 + SIGMAS * carried.error, "{carried:?}");
        }
    }
}

#[test]
fn rough_plastic_reflects_what_its_bsdf_says() {
    for (alpha, distribution) in [(0.1, Beckmann), (0.3, Ggx), (0.5, Beckmann)] {
        for nonlinear in [true, false] {
            let scene = with_facets(bare().plastic("floor", Some(alpha)), Some(distribution));
            let swatch = Swatch::new(linearity(scene, nonlinear), false);
            let rough = Rough::new(alpha, distribution);
            let base = rough.base(PLASTIC_COLOUR, nonlinear);
            // 2π∫T(c) c dc.
            let cosines = (0..100).map(|k| (k as f64 + 0.5) / 100.0);
            let out: f64 = cosines.map(|c| TAU * c * rough.through(c) / 100.0).sum();
            compare(&format!("{rough:?} plastic"), &swatch, TABLES, |i| {
                let gloss = |o: DVec3| DVec3::splat(rough.gloss(i, o));
                over_directions(reflect(i, DVec3::Z), rough.alpha, gloss)
                    + base * rough.through(i.z) * out
            });
        }
    }
}

/// White plastic reflects everything, up to the fit of what comes back from inside; coloured
/// plastic by its formula.
#[test]
fn smooth_plastic_reflects_what_its_bsdf_says() {
    for (colour, nonlinear) in [
        (PLASTIC_COLOUR, true),
        (PLASTIC_COLOUR, false),
        (DVec3::ONE, true),
    ] {
        let slots = [
            ("diffuse_reflectance", colour.as_vec3().to_array()),
            ("specular_reflectance", [1.0; 3]),
        ];
        let scene = with(bare().plastic("floor", None), &slots);
        let swatch = Swatch::new(linearity(scene, nonlinear), false);
        let cosines = (0..2000).map(|k| (k as f64 + 0.5) / 2000.0);
        let out: f64 = cosines
            .map(|c| TAU * c * (1.0 - dielectric(c, ETA)) / 2000.0)
            .sum();
        let base = base(colour, smooth_back_inside(), nonlinear);
        let energy = |i: DVec3| {
            let reflected = dielectric(i.z, ETA);
            DVec3::splat(reflected) + base * (1.0 - reflected) * out
        };
        if colour == DVec3::ONE {
            let lost = 1.0 - energy(incidence(45.0)).x;
            assert!(lost.abs() < 3e-3, "white plastic loses {lost}");
        }
        compare("smooth plastic", &swatch, ROUNDING, energy);
    }
}

fn linearity(mut scene: warpath::scene::Scene, is_nonlinear: bool) -> warpath::scene::Scene {
    let material = scene.meshes[0].material;
    if let warpath::scene::Bsdf::Plastic { nonlinear, .. } = &mut scene.materials[material].bsdf {
        *nonlinear = is_nonlinear;
    }
    scene
}
