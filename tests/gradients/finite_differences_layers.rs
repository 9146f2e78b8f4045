//! As `finite_differences`: masks and blends, layers, brushed metal and glass, panes.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::{Quiet, direction, flat, settings};
use warpath::methods::{Method, forward, render};
use warpath::scene::Distribution::{Beckmann, Ggx};
use warpath::scene::Scene;

const MOVED: (&str, &[f32]) = ("block.translation", &[1.0, 0.2, 0.1]);
/// As in `finite_differences_materials`.
const LONG_STEP: Option<f64> = Some(0.03);
/// Images are polynomials of fractions: any step will do, and which material is met changes for few
/// paths at short ones.
const WIDE_STEP: Option<f64> = Some(0.15);
const COARSE: f64 = 0.1;

fn made_of(scene: &Scene, spp: u32, key: &str, by: &[f32], step: Option<f64>) {
    println!("{key}");
    check_to(COARSE, scene, &[(key, by)], spp, step, Agrees);
}

#[test]
fn what_masks_and_blends_are_made_of() {
    let masked = room(4).metal("block", 0.3, Ggx).masked("block", 0.4);
    made_of(&masked, 64, "block.bsdf.opacity.value", &[1.0], WIDE_STEP);
    let colour = "block.bsdf.specular_reflectance.value";
    made_of(&masked, 64, colour, &[1.0, 0.5, 0.2], None);
    let blended = room(3).blended("floor", 0.6).masked("floor", 0.7);
    made_of(&blended, 64, "floor.bsdf.weight.value", &[1.0], WIDE_STEP);
    made_of(&blended, 64, "floor.bsdf.opacity.value", &[1.0], WIDE_STEP);
    made_of(&blended, 64, "floor.bsdf.alpha.value", &[1.0], LONG_STEP);
}

/// One sheet, looked through once: the image is linear in its opacity, and so the derivative is the
/// difference of what is there and what is not, also where one of them is not there at all.
#[test]
fn opacities_of_nothing_and_of_all() {
    let sheet = |opacity: f32| {
        let above = parallelogram(glam::vec3(-0.5, -0.5, 0.9), glam::Vec3::X, glam::Vec3::Y);
        let scene = small_floor().solid("sheet", above, [0.3, 0.6, 0.5]);
        let scene = scene.constant_environment(SKY).depth(2);
        scene.masked("sheet", opacity)
    };
    let image = |opacity: f32, seed: u64| {
        let scene = sheet(opacity);
        let settings = settings(&scene, Method::Reparam, 64, seed);
        flat(&render(&scene, &settings, &Quiet).expect("an image").image)
    };
    for opacity in [0.0, 1.0] {
        let scene = sheet(opacity);
        let along = direction(&scene, &[("sheet.bsdf.opacity.value", &[1.0])]);
        let runs: Vec<f64> = (0..16)
            .map(|seed| {
                let settings = settings(&scene, Method::Reparam, 64, seed);
                let gradient = forward(&scene, &settings, &along, &Quiet);
                let gradient = flat(&gradient.expect("a gradient").gradient);
                let there = image(1.0, 100 + seed);
                let not_there = image(0.0, 200 + seed);
                let pairs = there.iter().zip(&not_there).zip(&gradient);
                // Light that passes the sheet twice brings its square: none does at this depth.
                pairs.map(|((a, b), g)| g - (a - b)).sum::<f64>() / gradient.len() as f64
            })
            .collect();
        let n = runs.len() as f64;
        let mean = runs.iter().sum::<f64>() / n;
        let spread = runs.iter().map(|r| (r - mean).powi(2)).sum::<f64>();
        let error = (spread / (n - 1.0) / n).sqrt();
        println!("opacity {opacity}: off by {mean:.2e} ± {error:.2e}");
        assert!(error < 2e-3 && mean.abs() < 4.0 * error, "{mean} ± {error}");
    }
}

/// Parameters, whether the image is a polynomial of them, and whether they show near the plane
/// alone.
const LAYERS: [(&str, bool, bool); 10] = [
    ("roughness.value", false, false),
    ("anisotropic.value", false, false),
    ("metallic.value", true, false),
    ("specular", false, false),
    ("spec_tint.value", true, false),
    ("sheen.value", true, true),
    ("sheen_tint.value", true, true),
    ("flatness.value", true, true),
    ("clearcoat.value", true, true),
    ("clearcoat_gloss.value", false, true),
];

/// A floor that is seen from near its plane, where sheen and coats show.
fn low_floor() -> Scene {
    let from = glam::vec3(0.3, -3.4, 0.5);
    scene(from, glam::Vec3::ZERO, 20.0, [8; 2], GAUSSIAN)
        .solid("floor", floor(0.8, 0.0), [0.6, 0.5, 0.4])
        .constant_environment(SKY)
        .depth(2)
}

#[test]
fn what_layers_are_made_of() {
    let scene = room(3).layers("floor", 0.3);
    let low = low_floor().layers("floor", 0.3);
    for (name, is_polynomial, is_faint) in thinned(2, LAYERS) {
        let key = format!("floor.bsdf.{name}");
        let step = if is_polynomial { WIDE_STEP } else { LONG_STEP };
        let (scene, spp) = if is_faint { (&low, 768) } else { (&scene, 96) };
        made_of(scene, spp, &key, &[1.0], step);
    }
    let colour = "floor.bsdf.base_color.value";
    made_of(&low, 64, colour, &[1.0, 0.5, 0.2], LONG_STEP);
}

#[test]
fn what_clear_layers_are_made_of() {
    let scene = close_up()
        .constant_environment(SKY)
        .depth(5)
        .clear_layers("block", 0.3);
    for name in thinned(2, ["roughness.value", "metallic.value", "spec_trans.value"]) {
        let key = format!("block.bsdf.{name}");
        made_of(&scene, 128, &key, &[1.0], LONG_STEP);
    }
    let colour = "block.bsdf.base_color.value";
    made_of(&scene, 64, colour, &[1.0, 0.5, 0.2], LONG_STEP);
}

#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn what_clear_layers_show_is_bent() {
    let scene = close_up()
        .constant_environment(SKY)
        .depth(5)
        .clear_layers("block", 0.3);
    let bent = [("block.bsdf.specular", [1.0].as_slice())];
    check_to(COARSE, &scene, &bent, 256, LONG_STEP, Fails);
}

#[test]
fn what_brushed_things_are_made_of() {
    let metal = room(3).brushed("floor", [0.4, 0.2], Beckmann);
    for key in ["floor.bsdf.alpha_u.value", "floor.bsdf.alpha_v.value"] {
        made_of(&metal, 64, key, &[1.0], LONG_STEP);
    }
    let glass = close_up()
        .constant_environment(SKY)
        .depth(5)
        .brushed_glass("block", [0.2, 0.4]);
    made_of(&glass, 192, "block.bsdf.alpha_u.value", &[1.0], LONG_STEP);
}

#[test]
fn what_panes_are_made_of() {
    let scene = lit(close_up()).depth(4).pane("block");
    made_of(&scene, 64, "block.bsdf.eta", &[1.0], LONG_STEP);
    let colour = "block.bsdf.specular_transmittance.value";
    made_of(&scene, 64, colour, &[1.0, 0.5, 0.2], None);
}

#[test]
fn brushed_things_that_move() {
    let scene = room(3).brushed("floor", [0.5, 0.2], Ggx);
    check_to(COARSE, &scene, &[MOVED], 128, LONG_STEP, Fails);
    let turned = [("floor.rotation", [0.0, 0.0, 1.0].as_slice())];
    check_to(COARSE, &scene, &turned, 128, LONG_STEP, Fails);
}

#[test]
fn layers_that_move() {
    let scene = close_up()
        .constant_environment(SKY)
        .depth(3)
        .layers("floor", 0.2);
    check_to(COARSE, &scene, &[MOVED], 256, Some(0.01), Fails);
    let blended = room(3).blended("floor", 0.5);
    check_to(COARSE, &blended, &[MOVED], 128, LONG_STEP, Fails);
}

#[test]
fn what_reliefs_are_made_of() {
    let normals = room(3).relief("floor", None);
    let by = [1.0, 0.5, 0.2].as_slice();
    check_to(
        COARSE,
        &normals,
        &[("floor.bsdf.normalmap.data", by)],
        128,
        LONG_STEP,
        Fails,
    );
    let shiny = close_up()
        .constant_environment(SKY)
        .depth(3)
        .metal("floor", 0.15, Ggx)
        .relief("floor", None);
    let turned = [("floor.bsdf.normalmap.data", by)];
    check_to(COARSE, &shiny, &turned, 512, Some(0.01), Fails);
    let bumps = room(3).relief("floor", Some(0.1));
    let texels = bumps.textures.last().map_or(0, |t| t.texels.len());
    let ramp: Vec<f32> = (0..texels).map(|i| (i as f32 * 0.9).cos()).collect();
    let heights = [("floor.bsdf.nested_texture.data", ramp.as_slice())];
    // Normals turn, and edges that the floor sees with them.
    check_to(COARSE, &bumps, &heights, 128, Some(0.1), Fails);
}

#[test]
fn reliefs_that_move() {
    for bumps in [None, Some(0.1)] {
        let scene = close_up()
            .constant_environment(SKY)
            .depth(2)
            .relief("floor", bumps);
        check_to(0.05, &scene, &[MOVED], 128, Some(0.01), Fails);
        let slid = [("floor.translation", [1.0, 0.4, 0.1].as_slice())];
        check_to(COARSE, &scene, &slid, 256, Some(0.01), Fails);
    }
}
