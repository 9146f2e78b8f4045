//! What cells foretell of the noise of differences, against differences: right to a factor of two.

use common::comparison::{SKY, close_up};
use common::materials::Paint;
use common::scenes::*;
use common::{Direction, Quiet, direction, flat, settings};
use warpath::methods::{self, Method};
use warpath::scene::Distribution::Ggx;
use warpath::scene::{Scene, load};
use warpath::statistics::estimate::Estimate;

const SPP: u32 = 4;
const STEP: f64 = 2e-3;

/// The variance of the differences' image, from pairs of runs. Steps are so short that it is all of
/// what jumps.
fn measured(scene: &Scene, direction: &Direction) -> Estimate {
    let run = |seed| {
        let settings = settings(scene, Method::Fd, SPP, seed);
        let found = methods::difference(scene, &settings, direction, STEP, &Quiet);
        flat(&found.expect("differences").gradient)
    };
    let square = |pair: u64| {
        let [a, b] = [2 * pair, 2 * pair + 1].map(run);
        let halves = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2) / 2.0);
        halves.sum::<f64>()
    };
    Estimate::mean_of((0..512).map(square))
}

fn foretold(scene: &Scene, direction: &Direction) -> Estimate {
    let of = |seed| {
        let settings = settings(scene, Method::Reparam, SPP, seed);
        let found = methods::foretell_difference(scene, &settings, direction, STEP, &Quiet);
        found.expect("a variance")
    };
    Estimate::mean_of((1000..1016).map(of))
}

fn agrees(name: &str, key: &str) {
    let scene = load(format!("scenes/failures/{name}.xml"), &[]).expect("a scene");
    agrees_in(name, &scene, key);
}

fn agrees_in(name: &str, scene: &Scene, key: &str) {
    let along = direction(scene, &[(key, &[1.0, 0.2, 0.3])]);
    let (truth, told) = (measured(scene, &along), foretold(scene, &along));
    println!(
        "{name} {key}: measured {:.4} +- {:.4}, foretold {:.4} +- {:.4}",
        truth.value, truth.error, told.value, told.error
    );
    // What jumps is averaged over looks, and samples on a lattice are not independent.
    assert!(told.value - 4.0 * told.error > 0.5 * (truth.value + 4.0 * truth.error));
    assert!(told.value + 4.0 * told.error < 2.0 * (truth.value - 4.0 * truth.error));
}

#[test]
fn shadows() {
    agrees("shadow_sizes", "light.translation");
}

#[test]
fn silhouettes_on_the_film() {
    agrees("shadow_sizes", "obj.translation");
}

#[test]
fn what_bounces_meet() {
    agrees("sky_shadow", "obj.translation");
}

/// Narrow lobes are dense: a path that they hold carries no more for that.
#[test]
fn what_narrow_lobes_meet() {
    let scene = close_up().constant_environment(SKY).depth(2);
    let scene = scene.metal("floor", 0.05, Ggx);
    agrees_in("metal", &scene, "block.translation");
}
