//! Bounces of every material: directions and the chances of lobes.

use super::*;
use common::materials::Paint;
use common::optics::*;
use common::swatch::{Bounce, Swatch, bare, with};
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;
use warpath::paths::surface::layered_sample::{coat_normal, pdf_coat_normal};
use warpath::scene::Distribution::{Beckmann, Ggx};

const DEGREES: [f64; 4] = [1.0, 40.0, 70.0, 85.0];
const BINS: usize = 20;
/// Each takes a stream.
const BOUNCES: u32 = 1 << 16;

/// One lobe: bins about its main direction, its density over solid angle, and whose bounces it
/// counts.
struct Lobe<'a> {
    cap: Cap,
    density: Box<dyn Fn(DVec3) -> f64 + 'a>,
    drew: fn(&Bounce) -> bool,
}

fn diffuse<'a>(chance: f64) -> Lobe<'a> {
    Lobe {
        // The horizon is a border of bins.
        cap: Cap::new(DVec3::Z, 1.0),
        density: Box::new(move |o| chance * o.z.max(0.0) * FRAC_1_PI),
        drew: |b| b.lobes.diffuse == 1,
    }
}

/// Normals are drawn from GGX's visible ones whatever the distribution.
fn reflected<'a>(i: DVec3, alpha: f64, chance: impl Fn(f64) -> f64 + 'a) -> Lobe<'a> {
    let density = move |o: DVec3| {
        let (h, jacobian) = reflecting(i, o);
        chance(i.dot(h)) * visible(i, h, alpha, Ggx) * jacobian
    };
    Lobe {
        cap: Cap::new(reflect(i, DVec3::Z), alpha),
        density: Box::new(density),
        drew: |b| b.lobes.reflected == 1,
    }
}

fn refracted<'a>(i: DVec3, alpha: f64, ratio: f64) -> Lobe<'a> {
    let density = move |o: DVec3| {
        let Some((h, jacobian)) = refracting(i, o, ratio) else {
            return 0.0;
        };
        (1.0 - dielectric(i.dot(h), ratio)) * visible(i, h, alpha, Ggx) * jacobian
    };
    // Beyond the critical angle the lobe lies along the surface.
    let main = refract(i, DVec3::Z, ratio).unwrap_or(DVec3::new(-i.x, -i.y, 0.0).normalize());
    Lobe {
        cap: Cap::new(main, alpha / 2.0),
        density: Box::new(density),
        drew: |b| b.lobes.refracted == 1,
    }
}

fn check(what: &str, swatch: &Swatch, lobes: impl Fn(DVec3) -> Vec<Lobe<'static>>) {
    let toward = DEGREES.map(incidence);
    let lobes: Vec<Vec<Lobe>> = toward.iter().map(|i| lobes(*i)).collect();
    let mut counts: Vec<Vec<usize>> = lobes
        .iter()
        .map(|l| vec![0; l.len() * BINS * BINS])
        .collect();
    swatch.bounces(&toward, BOUNCES, 1, |_, lane, bounce| {
        let drawn = lobes[lane].iter().position(|l| (l.drew)(&bounce));
        let drawn = drawn.unwrap_or_else(|| panic!("{what}: a lobe that is not there"));
        let at = lobes[lane][drawn].cap.place(bounce.direction.normalize());
        let [x, y] = at.map(|x| (x.min(1.0 - 1e-7)) as f32);
        counts[lane][(drawn * BINS + bin(x, BINS)) * BINS + bin(y, BINS)] += 1;
    });
    for ((degrees, lobes), counts) in DEGREES.iter().zip(&lobes).zip(&counts) {
        let shares: Vec<f64> = lobes
            .iter()
            .flat_map(|l| l.cap.integrals(BINS, 16, &l.density))
            .collect();
        expect_shares(&format!("{what} at {degrees}°"), counts, &shares);
    }
}

#[test]
fn diffuse_bounces() {
    check("diffuse", &Swatch::new(bare(), false), |_| {
        vec![diffuse(1.0)]
    });
}

#[test]
fn bounces_off_metal() {
    for (alpha, distribution) in [(0.1, Ggx), (0.3, Beckmann), (0.7, Ggx)] {
        let swatch = Swatch::new(bare().metal("floor", alpha, distribution), false);
        check(&format!("metal of {alpha}"), &swatch, |i| {
            vec![reflected(i, alpha.into(), |_| 1.0)]
        });
    }
}

/// The chance of the specular lobe: as `paths::surface::lobe_sample` documents it, by the means of
/// plain colours.
fn specular_chance(i: DVec3) -> f64 {
    let reflected = dielectric(i.z, 1.5);
    let (specular, diffuse) = (0.9 * reflected, (0.6 + 0.3 + 0.2) / 3.0 * (1.0 - reflected));
    (specular / (specular + diffuse)).clamp(0.1, 0.9)
}

#[test]
fn bounces_off_plastic() {
    for alpha in [0.1, 0.3] {
        let swatch = Swatch::new(bare().plastic("floor", Some(alpha)), false);
        check(&format!("plastic of {alpha}"), &swatch, |i| {
            let chance = specular_chance(i);
            let specular = reflected(i, alpha.into(), move |_| chance);
            vec![specular, diffuse(1.0 - chance)]
        });
    }
}

#[test]
fn bounces_off_and_through_glass() {
    for (alpha, inside) in [(0.1, false), (0.4, false), (0.1, true), (0.4, true)] {
        let swatch = Swatch::new(bare().glass("floor", alpha), inside);
        let side = if inside { "inside" } else { "outside" };
        check(&format!("glass of {alpha} from {side}"), &swatch, |i| {
            let ratio = if inside { 1.0 / 1.5 } else { 1.5 };
            let alpha = f64::from(alpha);
            let mirrored = reflected(i, alpha, move |cos| dielectric(cos, ratio));
            vec![mirrored, refracted(i, alpha, ratio)]
        });
    }
}

/// What light samples are weighed against is the density of the bounces, above the horizon.
#[test]
fn wide_lobes_tell_their_density() {
    let paints: [(&str, Swatch, Option<f64>, bool); 5] = [
        ("diffuse", Swatch::new(bare(), false), None, false),
        (
            "narrow metal",
            Swatch::new(bare().metal("floor", 0.1, Ggx), false),
            None,
            true,
        ),
        (
            "metal",
            Swatch::new(bare().metal("floor", 0.3, Beckmann), false),
            Some(0.3),
            true,
        ),
        (
            "narrow plastic",
            Swatch::new(bare().plastic("floor", Some(0.1)), false),
            None,
            false,
        ),
        (
            "plastic",
            Swatch::new(bare().plastic("floor", Some(0.3)), false),
            Some(0.3),
            false,
        ),
    ];
    for (what, swatch, wide, is_metal) in paints {
        let view = swatch.view();
        for degrees in DEGREES {
            let i = incidence(degrees);
            let (vertices, surface) = swatch.seen(&view, &[i]);
            let specular = match what {
                "diffuse" => 0.0,
                _ if is_metal => 1.0,
                _ => specular_chance(i),
            };
            for place in 0..256 {
                let at = [(place / 16) as f64 + 0.5, (place % 16) as f64 + 0.5].map(|x| x / 16.0);
                let (o, _) = Cap::new(reflect(i, DVec3::Z), 0.5).direction(at);
                if o.z <= 0.0 {
                    continue;
                }
                let d = swatch.packet(&[o]);
                let told = view.bsdf_pdf_over_cos(&vertices, &surface, d);
                let lobe =
                    wide.map_or(0.0, |alpha| (reflected(i, alpha, |_| 1.0).density)(o) / o.z);
                let wanted = specular * lobe + (1.0 - specular) * FRAC_1_PI;
                let told = f64::from(told.to_array()[0]);
                assert!(
                    (told - wanted).abs() <= 1e-4 * wanted,
                    "{what} at {degrees}°: {told} against {wanted} toward {o}"
                );
            }
        }
    }
}

/// D·G₁(i)·(i·h)/cᵢ of GGX that is stretched along x and y.
fn brushed(i: DVec3, h: DVec3, [along, across]: [f64; 2]) -> f64 {
    let stretched = (h.x / along).powi(2) + (h.y / across).powi(2) + h.z * h.z;
    let facets = 1.0 / (std::f64::consts::PI * along * across * stretched * stretched);
    if h.z <= 0.0 {
        return 0.0;
    }
    let slope2 = ((along * i.x).powi(2) + (across * i.y).powi(2)) / (i.z * i.z);
    let shown = 2.0 / (1.0 + (1.0 + slope2).sqrt());
    facets * shown * i.dot(h).max(0.0) / i.z
}

/// Normals are drawn from GGX's whatever the distribution.
#[test]
fn bounces_off_brushed_metal() {
    for (alphas, distribution) in [([0.4f32, 0.1], Ggx), ([0.15, 0.6], Beckmann)] {
        let scene = bare().brushed("floor", alphas, distribution);
        let swatch = Swatch::new(scene, false);
        check(&format!("metal brushed to {alphas:?}"), &swatch, |i| {
            let alphas = alphas.map(f64::from);
            let density = move |o: DVec3| {
                let (h, jacobian) = reflecting(i, o);
                brushed(i, h, alphas) * jacobian
            };
            vec![Lobe {
                cap: Cap::new(reflect(i, DVec3::Z), 0.3),
                density: Box::new(density),
                drew: |b| b.lobes.reflected == 1,
            }]
        });
    }
}

/// As `paths::surface::layered_sample` documents the chances, for the numbers of
/// `common::materials`; without the coat, some of whose normals reflect nothing.
#[test]
fn bounces_off_and_through_layers() {
    let root = (0.08f64 * 0.6).sqrt();
    let eta = 2.0 / (1.0 - root) - 1.0;
    // α/√(1 − 0.9·0.4) and α·√(1 − 0.9·0.4), of α = 0.3.
    let alphas = [0.3 / 0.8, 0.3 * 0.8];
    for (inside, transmits) in [(false, 0.0), (false, 0.6), (true, 0.6)] {
        let scene = if transmits == 0.0 {
            bare().layers("floor", 0.3)
        } else {
            bare().clear_layers("floor", 0.3)
        };
        let swatch = Swatch::new(with(scene, &[("clearcoat", [0.0; 3])]), inside);
        let what = format!("layers that let {transmits} through, inside {inside}");
        check(&what, &swatch, |i| {
            let ratio = if inside { 1.0 / eta } else { eta };
            let base = if inside {
                0.0
            } else {
                0.7 * (1.0 - transmits) + 0.25 * 0.7 * 0.7
            };
            let of_base = base / (1.0 + base);
            let part = if inside { 1.0 } else { 0.7 * transmits };
            let passes = move |cos: f64| part * (1.0 - dielectric(cos, ratio));
            let mirrored = move |o: DVec3| {
                let (h, jacobian) = reflecting(i, o);
                let chance = (1.0 - of_base) * (1.0 - passes(i.dot(h)));
                chance * brushed(i, h, alphas) * jacobian
            };
            let mut lobes = vec![Lobe {
                cap: Cap::new(reflect(i, DVec3::Z), 0.3),
                density: Box::new(mirrored),
                drew: |b| b.lobes.reflected == 1,
            }];
            if base > 0.0 {
                lobes.push(diffuse(of_base));
            }
            if transmits > 0.0 {
                let bent = move |o: DVec3| {
                    refracting(i, o, ratio).map_or(0.0, |(h, jacobian)| {
                        let chance = (1.0 - of_base) * passes(i.dot(h));
                        chance * brushed(i, h, alphas) * jacobian
                    })
                };
                let main = refract(i, DVec3::Z, ratio);
                let main = main.unwrap_or(DVec3::new(-i.x, -i.y, 0.0).normalize());
                lobes.push(Lobe {
                    cap: Cap::new(main, 0.15),
                    density: Box::new(bent),
                    drew: |b| b.lobes.refracted == 1,
                });
            }
            lobes
        });
    }
}

/// GTR1: (α² − 1)/(π ln α² (1 + (α² − 1)c²)), times the cosine.
#[test]
fn normals_of_coats() {
    for gloss in [0.0, 0.3, 1.0] {
        let alpha2 = f64::powi(0.1 - 0.099 * gloss, 2);
        let choices = pairs(41, 3, 7).map(|p| p.map(f64::from));
        let mut counts = vec![0; BINS * BINS];
        for choice in choices {
            let h = coat_normal(gloss, choice);
            assert!((h.length() - 1.0).abs() < 1e-12 && h.z >= 0.0);
            let sin2 = h.x * h.x + h.y * h.y;
            // The part of all normals that are nearer to the surface's.
            let nearer = (1.0 + sin2 * (1.0 - alpha2) / alpha2).ln() / -alpha2.ln();
            let turn = h.y.atan2(h.x) / std::f64::consts::TAU + 0.5;
            let [x, y] = [nearer, turn].map(|x| x.clamp(0.0, 1.0 - 1e-7) as f32);
            counts[bin(x, BINS) * BINS + bin(y, BINS)] += 1;
            let wanted = (alpha2 - 1.0) / (alpha2.ln() * (alpha2 + (1.0 - alpha2) * sin2));
            let wanted = wanted * h.z * FRAC_1_PI;
            let told = pdf_coat_normal(gloss, h);
            assert!((told - wanted).abs() < 1e-9 * wanted, "{told}, {wanted}");
        }
        uniform(&format!("normals of a coat of gloss {gloss}"), &counts);
    }
}
