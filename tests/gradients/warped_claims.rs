//! Methods that move samples against finite differences: right where their authors claim it, and
//! biased where they say so.

use common::comparison::*;
use common::fading::fading;
use common::materials::Paint;
use common::scenes::*;
use common::statistics::Agreement;
use common::{direction, gradient, settings};
use glam::vec3;
use warpath::methods::{Constants, Method, Settings};
use warpath::scene::{Distribution, Scene};
use warpath::warp::options::WarpOptions;

/// Independent runs of each method.
const RUNS: u64 = 12;

type Motion<'a> = &'a [(&'a str, &'a [f32])];

/// How a method with `spp` samples agrees with finite differences with `fd_spp`.
fn agreement(
    scene: &Scene,
    motion: Motion,
    (method, warp): (Method, WarpOptions),
    [spp, fd_spp]: [u32; 2],
) -> Agreement {
    let along = direction(scene, motion);
    let runs = |method: Method, spp: u32, first: u64| -> Vec<Vec<f64>> {
        (first..first + RUNS)
            .map(|seed| {
                let settings = Settings {
                    constants: Constants {
                        warp,
                        ..Constants::default()
                    },
                    ..settings(scene, method, spp, seed)
                };
                gradient(scene, &settings, &along)
            })
            .collect()
    };
    let found = Agreement::new(&runs(method, spp, 1), &runs(Method::Fd, fd_spp, 1000));
    println!("{} {found:.4?}", method.name());
    found
}

const MOVED: Motion = &[("block.translation", &[1.0, 0.2, 0.4])];

/// A floor below a block that is out of sight.
fn floor_alone() -> Scene {
    let (from, at) = (vec3(0.3, -3.4, 1.9), vec3(0.0, -0.1, -0.2));
    scene(from, at, 18.0, [12; 2], GAUSSIAN)
        .solid("floor", floor(2.0, 0.0), [0.6, 0.5, 0.4])
        .solid("block", block(), [0.3, 0.6, 0.5])
}

/// Rigid motion before an even sky: one silhouette in most pixels, which a rotation holds still.
#[test]
fn loubet_is_right_on_silhouettes() {
    let usual = WarpOptions::default();
    let scene = silhouette(GAUSSIAN);
    let found = agreement(&scene, MOVED, (Method::Loubet, usual), [128, 512]);
    assert!(found.bias.error < 0.02 && found.holds(4.0), "{found:.4?}");
}

/// What hides the sky from a rough metal is found through the kernels around directions. The block
/// itself is out of sight. What a bundle follows depends on the samples that it multiplies: alone
/// they lose about the part 1/n of the gradient, with n rays before a bright sky, in pairs next to
/// none of it.
#[test]
fn loubet_needs_pairs_of_paths() {
    let scene = floor_alone()
        .constant_environment(SKY)
        .metal("floor", 0.3, Distribution::Ggx);
    let by = |pairs: bool| {
        let mut options = WarpOptions::default();
        options.loubet.pairs = pairs;
        agreement(&scene, MOVED, (Method::Loubet, options), [256, 512])
    };
    let (pairs, single) = (by(true), by(false));
    assert!(pairs.bias.error < 0.06 && pairs.holds(4.0), "{pairs:.4?}");
    let bias = single.bias;
    assert!(bias.value < -4.0 * bias.error, "{single:.4?}");
}

/// The sharp border of a light does not turn with what hides the light, which its authors admit: of
/// a shadow alone nothing is left. A light that fades to its border is what they use.
#[test]
fn loubet_needs_lights_that_fade() {
    let usual = WarpOptions::default();
    let scene = || lit(floor_alone());
    let by = |scene: &Scene| agreement(scene, MOVED, (Method::Loubet, usual), [256, 512]).bias;
    let (sharp, fading) = (by(&scene()), by(&fading(scene(), "lamp")));
    assert!(sharp.value < -4.0 * sharp.error, "{sharp:.4?}");
    let apart = sharp.error.hypot(fading.error);
    assert!(fading.value - sharp.value > 4.0 * apart, "{fading:.4?}");
}

/// The bias of few rays falls as their number grows (as one over it).
#[test]
fn warped_area_is_consistent() {
    let scene = silhouette(GAUSSIAN);
    let by = |rays: u32| {
        let mut options = WarpOptions::default();
        options.warped_area.rays = rays;
        options.warped_area.antithetic = false;
        let found = agreement(&scene, MOVED, (Method::WarpedArea, options), [64, 512]);
        found.bias
    };
    let (few, many) = (by(8), by(64));
    assert!(few.value < -4.0 * few.error, "{few:.4?}");
    let apart = few.error.hypot(2.0 * many.error);
    assert!(
        few.value - 2.0 * many.value < -4.0 * apart,
        "{few:.4?}, {many:.4?}"
    );
}

/// Russian roulette over the number of rays leaves no bias, and much noise.
#[test]
fn warped_area_can_do_without_bias() {
    let mut options = WarpOptions::default();
    options.warped_area.debias = true;
    let scene = shadow();
    let found = agreement(&scene, MOVED, (Method::WarpedArea, options), [64, 512]);
    let bias = found.bias;
    assert!(bias.value.abs() < 4.0 * bias.error, "{found:.4?}");
}
