//! Microfacet normals, in coordinates in which GGX's own are even.

use super::*;
use common::optics::*;
use warpath::paths::surface::microfacet_sample::{pdf_normal, visible_normal, weight};
use warpath::scene::Distribution::{Beckmann, Ggx};

const ALPHAS: [f64; 3] = [0.01, 0.3, 1.0];
const DEGREES: [f64; 4] = [0.0, 40.0, 75.0, 89.0];
const BINS: usize = 24;

#[test]
fn visible_normals_have_their_density() {
    let choices: Vec<[f64; 2]> = pairs(31, 2, 5).map(|p| p.map(f64::from)).collect();
    for alpha in ALPHAS {
        for degrees in DEGREES {
            let i = incidence(degrees);
            let mut counts = vec![0; BINS * BINS];
            for choice in &choices {
                let h = visible_normal(i, alpha, *choice);
                assert!((h.length() - 1.0).abs() < 1e-12 && h.z >= 0.0);
                let [x, y] = place_of_normal(h, alpha).map(|x| x.min(1.0 - 1e-7) as f32);
                counts[bin(x, BINS) * BINS + bin(y, BINS)] += 1;
            }
            let shares = integrals(BINS, 16, |at| {
                let (h, area) = normal_at(at, alpha);
                pdf_normal(i, h, alpha) * area
            });
            let what = format!("normals of roughness {alpha} seen at {degrees}°");
            expect_shares(&what, &counts, &shares);
        }
    }
}

/// The density is that of the formulas, and the weight turns it into Beckmann's, which is
/// normalised as well as its rational fit of G₁ lets it be.
#[test]
fn densities_and_weights_are_those_of_the_formulas() {
    for alpha in [1e-3, 0.01, 0.3, 1.0] {
        for degrees in [0.0, 40.0, 75.0, 89.0, 89.99] {
            let i = incidence(degrees);
            for place in 0..400 {
                let at = [(place / 20) as f64 + 0.5, (place % 20) as f64 + 0.5].map(|x| x / 20.0);
                let (h, _) = normal_at(at, alpha);
                let (density, wanted) = (pdf_normal(i, h, alpha), visible(i, h, alpha, Ggx));
                // 1 − z² leaves the formulas this many digits, and the kernels' sin² is 1e-8 at
                // least.
                let rounding = 1e-13 / (alpha * alpha) + 5e-9;
                assert!(
                    (density - wanted).abs() <= rounding * wanted,
                    "{density} against {wanted} at {degrees}°, roughness {alpha}, {h}"
                );
                if wanted > 0.0 {
                    let ratio = visible(i, h, alpha, Beckmann) / wanted;
                    let got = weight(i, h, alpha, false);
                    // The kernel bounds 1/z⁴ at z² = 1e-6.
                    let is_bounded = h.z < 1e-3;
                    assert!(
                        is_bounded || (got - ratio).abs() <= 10.0 * rounding * ratio + 1e-12,
                        "{got} against {ratio} at {degrees}°, roughness {alpha}, {h}"
                    );
                    assert_eq!(weight(i, h, alpha, true), 1.0);
                }
            }
        }
    }
}
