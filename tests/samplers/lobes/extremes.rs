//! Nothing breaks at extreme roughness and grazing angles: in single precision, as paths have it.

use common::materials::Paint;
use common::swatch::{Swatch, bare, with_facets};
use glam::{DVec3, dvec3};
use warpath::lanes::{LANES, Lane, V3};
use warpath::paths::rays::lane_of;
use warpath::paths::surface::kinds::LightKind;
use warpath::scene::Distribution::{self, Beckmann, Ggx};

/// From the least that scenes may ask for.
const ALPHAS: [f32; 6] = [1e-4, 1e-3, 0.01, 0.1, 0.5, 1.0];
const COSINES: [f64; 6] = [1e-5, 1e-3, 0.01, 0.1, 0.7, 1.0];
const STREAMS: u32 = 4;
const POINTS: u32 = 256;

fn toward() -> [DVec3; 6] {
    COSINES.map(|cos| {
        let sin = (1.0 - cos * cos).sqrt();
        dvec3(0.6 * sin, -0.8 * sin, cos)
    })
}

fn swatches(alpha: f32, distribution: Distribution) -> Vec<(&'static str, Swatch)> {
    let of = |scene| with_facets(scene, Some(distribution));
    let metal = bare().metal("floor", alpha, distribution);
    let glass = || of(bare().glass("floor", alpha));
    let plastic = of(bare().plastic("floor", Some(alpha)));
    vec![
        ("metal", Swatch::new(metal, false)),
        ("glass", Swatch::new(glass(), false)),
        ("glass from inside", Swatch::new(glass(), true)),
        ("plastic", Swatch::new(plastic, false)),
    ]
}

#[test]
fn bounces_are_finite_and_carry_no_more_than_arrives() {
    for alpha in ALPHAS {
        for distribution in [Ggx, Beckmann] {
            for (what, swatch) in swatches(alpha, distribution) {
                let mut sums = [0.0; 6];
                // Radiance is squeezed on its way out of glass.
                let most = if what == "glass from inside" {
                    1.5f32.powi(2)
                } else {
                    1.0
                };
                swatch.bounces(&toward(), STREAMS, POINTS, |_, lane, b| {
                    let place =
                        format!("{what} of {alpha} ({distribution:?}) at {}", COSINES[lane]);
                    let length = b.direction.length();
                    assert!(
                        (length - 1.0).abs() < 1e-4,
                        "{place}: a direction of length {length}"
                    );
                    let w = b.weight;
                    assert!(w.is_finite() && w.min_element() >= 0.0, "{place}: {w}");
                    // Beckmann's lobe is at most 4/e times that of GGX, from which normals are
                    // drawn; its fit of G₁ is up to 3.535/2 times GGX's. Plastics' lobes are drawn
                    // with other chances than theirs.
                    let chance = if what == "plastic" { 10.0 } else { 1.0 };
                    assert!(w.max_element() <= 2.61 * most * chance, "{place}: {w}");
                    sums[lane] += w.max_element() / (STREAMS * POINTS) as f32;
                });
                for (sum, cos) in sums.iter().zip(COSINES) {
                    // Some thousand stratified points leave a few percent.
                    let is_dark = *sum <= most * 1.05;
                    assert!(
                        is_dark,
                        "{what} of {alpha} ({distribution:?}) at {cos}: {sum}"
                    );
                }
            }
        }
    }
}

#[test]
fn values_and_densities_toward_lights_are_finite() {
    for alpha in ALPHAS {
        for distribution in [Ggx, Beckmann] {
            for (what, swatch) in swatches(alpha, distribution) {
                let view = swatch.view();
                let (vertices, surface) = swatch.seen(&view, &toward());
                for o in toward() {
                    // The mirror image is where the lobe is highest.
                    for o in [o, dvec3(-o.x, -o.y, o.z), DVec3::Z] {
                        let d = swatch.packet(&[o]);
                        let density = view.bsdf_pdf_over_cos(&vertices, &surface, d);
                        let place = format!("{what} of {alpha} ({distribution:?}) toward {o}");
                        for light in [LightKind::Sampled, LightKind::Delta] {
                            let value = view.bsdf_evaluate(&vertices, &surface, d, light);
                            check_lanes(&place, value, density);
                        }
                    }
                }
            }
        }
    }
}

fn check_lanes(place: &str, value: V3<Lane>, density: Lane) {
    for lane in 0..LANES {
        let (value, density) = (lane_of(value, lane), density.to_array()[lane]);
        let is_number = value.is_finite() && value.min_element() >= 0.0;
        assert!(is_number, "{place}, lane {lane}: {value}");
        assert!(
            density.is_finite() && density >= 0.0,
            "{place}, lane {lane}: {density}"
        );
    }
}
