//! Images and gradients of the whole engine on either backend, with the same random numbers.

use common::{Quiet, direction, settings};
use warpath::methods::{self, Image, Method, Settings};
use warpath::scene::{Scene, load};
use warpath::trace::Backend;

fn demo() -> Scene {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/demo.xml");
    load(path, &[("res".into(), "48".into())]).expect("the demo scene")
}

fn on(backend: &str, scene: &Scene, threads: usize) -> Settings {
    Settings {
        backend: backend.parse().expect("a backend"),
        standard_error: true,
        threads,
        ..settings(scene, Method::Reparam, 32, 7)
    }
}

fn forward(scene: &Scene, settings: &Settings) -> (Image, Image) {
    let along = direction(scene, &[("occluder.translation", &[1.0, 0.0, 0.0])]);
    let done = methods::forward(scene, settings, &along, &Quiet).expect("a gradient");
    (done.gradient, done.stderr.expect("an error"))
}

fn numbers(image: &Image) -> impl Iterator<Item = f64> + '_ {
    image.pixels.iter().flatten().map(|x| f64::from(*x))
}

#[test]
fn gradients_agree_within_error_bars_and_to_rounding_where_hits_do() {
    let scene = demo();
    let (embree, error) = forward(&scene, &on("embree", &scene, 1));
    let (obvhs, _) = forward(&scene, &on("obvhs", &scene, 1));
    let largest = numbers(&embree).map(f64::abs).fold(0.0, f64::max);
    // Where all hits are the same, so is what follows from them; a number that differs by more than
    // rounding has met another triangle somewhere.
    let pairs = || numbers(&embree).zip(numbers(&obvhs)).zip(numbers(&error));
    let apart = pairs()
        .filter(|((a, b), _)| (a - b).abs() > 1e-5 * largest)
        .count();
    let share = apart as f64 / numbers(&embree).count() as f64;
    let square = |of: &dyn Fn(((f64, f64), f64)) -> f64| pairs().map(of).sum::<f64>();
    let z2 = square(&|((a, b), _)| (a - b) * (a - b)) / square(&|(_, e)| e * e);
    println!("{apart} numbers apart, {share:.4} of all; difference² / error² {z2:.2e}");
    assert!(share < 0.05, "{share} of the numbers differ");
    // The same random numbers: far closer than two independent runs, whose ratio is 2.
    assert!(z2 < 0.1, "{z2}");
}

#[test]
fn every_tree_and_preset_gives_the_same_bytes() {
    let scene = demo();
    let first = forward(&scene, &on("obvhs", &scene, 1));
    for (backend, threads) in [
        ("obvhs", 2),
        ("obvhs:fastest", 1),
        ("obvhs:slow", 2),
        ("obvhs-bvh2", 2),
    ] {
        let other = forward(&scene, &on(backend, &scene, threads));
        assert!(first == other, "{backend} on {threads} threads");
    }
    assert!(Backend::built_in().len() >= 3);
}
