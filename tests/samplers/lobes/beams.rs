//! Beams of delta lights show the BSDF, whatever the width of its lobes.

use super::formulas::*;
use common::materials::Paint;
use common::optics::*;
use common::swatch::{Swatch, bare, with_facets};
use glam::DVec3;
use warpath::lanes::LANES;
use warpath::paths::rays::lane_of;
use warpath::paths::store::DeltaSight;
use warpath::scene::Distribution::{Beckmann, Ggx};
use warpath::scene::{DeltaLight, DeltaLightKind, Scene, Texture};

/// Single precision, of lobes as narrow as 0.02.
const ROUNDING: f64 = 2e-3;

/// The scene with a beam of unit irradiance that comes from the direction `w` of the world.
fn beam(mut scene: Scene, w: DVec3) -> Scene {
    scene.delta_lights.push(DeltaLight {
        key: "sun".into(),
        kind: DeltaLightKind::Directional {
            direction: -w.as_vec3(),
        },
        power: scene.textures.len(),
        beam: None,
    });
    let power = Texture::constant("sun.irradiance".into(), [1.0; 3]);
    scene.textures.push(power);
    scene
}

/// Compares beams near the directions `o` in which a surface seen from `i` is bright.
fn compare(
    what: &str,
    scene: &Scene,
    inside: bool,
    o: impl Fn(DVec3) -> Option<DVec3>,
    wanted: impl Fn(DVec3, DVec3) -> DVec3,
) {
    let mut bright = 0;
    for degrees in [1.0, 30.0, 45.0, 70.0] {
        let i = incidence(degrees);
        let Some(mirror) = o(i) else { continue };
        for aside in [DVec3::ZERO, DVec3::X, DVec3::new(-0.5, 1.0, 0.3)] {
            let o = (mirror + aside * 0.02).normalize();
            let turned = Swatch::new(scene.clone(), inside).turned(o);
            let swatch = Swatch::new(beam(scene.clone(), turned), inside);
            let view = swatch.view();
            let (vertices, surface) = swatch.seen(&view, &[i]);
            let all = [DeltaSight {
                seen: (1 << LANES) - 1,
                hidden: 0,
            }];
            let brings = view.delta_light(&vertices, &surface, &all);
            let brings = lane_of(brings, 0).as_dvec3();
            let wanted = wanted(i, o);
            let error = (brings - wanted).abs().max_element();
            bright += usize::from(wanted.max_element() > 1e-3);
            assert!(
                error <= ROUNDING * wanted.max_element() + 1e-6,
                "{what} at {degrees}° toward {o}: {brings}, BSDF {wanted}"
            );
        }
    }
    assert!(bright >= 6, "{what}: only {bright} beams show anything");
}

#[test]
fn of_metal() {
    for (alpha, distribution) in [(0.02, Ggx), (0.1, Beckmann), (0.5, Ggx)] {
        let rough = Rough::new(alpha, distribution);
        let scene = bare().metal("floor", alpha, distribution);
        let mirror = |i| Some(reflect(i, DVec3::Z));
        compare(
            &format!("{rough:?} metal"),
            &scene,
            false,
            mirror,
            |i, o| rough.metal(i, o),
        );
    }
}

#[test]
fn of_glass() {
    for (alpha, distribution) in [(0.05, Ggx), (0.1, Beckmann), (0.5, Ggx)] {
        let rough = Rough::new(alpha, distribution);
        let scene = with_facets(bare().glass("floor", alpha), Some(distribution));
        for (inside, ratio) in [(false, ETA), (true, 1.0 / ETA)] {
            let what = |way| format!("{rough:?} glass, inside {inside}, {way}");
            let wanted = |i, o| rough.glass(i, o, ratio);
            let mirror = |i| Some(reflect(i, DVec3::Z));
            compare(&what("reflected"), &scene, inside, mirror, wanted);
            let through = |i| refract(i, DVec3::Z, ratio);
            compare(&what("refracted"), &scene, inside, through, wanted);
        }
    }
}
