//! A film that is sampled where the noise lies: the same in the mean as one that is sampled evenly,
//! and less noisy.

use common::comparison::{SIGMAS, SKY, thinned};
use common::scenes::*;
use common::shapes::Random;
use common::transposition::{all_parameters, both_sides_by, difference, prepared};
use common::{Direction, Quiet, direction, flat, settings};
use glam::vec3;
use std::ops::Range;
use std::sync::Arc;
use warpath::methods::{
    Constants, ForwardGradient, Image, Method, Mixture, NoiseMap, Question, Settings, decide,
    forward,
};
use warpath::scene::{Filter, Scene, load};
use warpath::statistics::agreement::Agreement;

const RUNS: u64 = 16;
const SIZE: [u32; 2] = [80, 64];

/// A dented ball over a floor, before the sky and under a lamp.
fn ball_over_a_floor(filter: Filter) -> Scene {
    let ball = spiky(vec3(0.5, 0.4, 0.4), 0.3, [1.0, 0.85]);
    scene(
        vec3(0.3, -5.0, 3.0),
        vec3(0.0, 0.0, 0.2),
        50.0,
        SIZE,
        filter,
    )
    .depth(3)
    .constant_environment(SKY)
    .solid("floor", floor(4.0, 0.0), [0.6, 0.5, 0.4])
    .smooth("ball", ball, [0.8; 3])
    .light("lamp", ceiling(vec3(0.2, 0.1, 3.0), 0.3), [60.0; 3])
}

fn along(scene: &Scene) -> Direction {
    direction(scene, &[("ball.translation", &[1.0, 0.2, 0.4])])
}

/// Samples in a few blocks of the film's, as if all the noise were there, and the same everywhere.
fn uneven_and_even(scene: &Scene, method: Method) -> [Settings; 2] {
    let even = Settings {
        constants: Constants {
            mixture: Some(Mixture::default()),
            ..Constants::default()
        },
        standard_error: true,
        ..settings(scene, method, 32, 1)
    };
    let noisy = [[2, 3], [5, 4], [6, 4]];
    let of_block = |at| [if noisy.contains(&at) { 1.0 } else { 1e-4 }, 1.0];
    let noise = NoiseMap::of_blocks(SIZE.map(|s| s as usize), of_block);
    assert!(noise.plan(SIZE.map(|s| s as usize), 8, 2).is_some());
    let uneven = Settings {
        noise: Some(Arc::new(noise)),
        ..even.clone()
    };
    [uneven, even]
}

/// Gradients and images with these seeds.
fn runs(scene: &Scene, own: &Settings, seeds: Range<u64>) -> [Vec<Vec<f64>>; 2] {
    let run = |seed| {
        let own = Settings {
            seed,
            ..own.clone()
        };
        forward(scene, &own, &along(scene), &Quiet).expect("a gradient")
    };
    let all: Vec<_> = seeds.map(run).collect();
    let of = |image: &dyn Fn(&ForwardGradient) -> &Image| {
        all.iter().map(|done| flat(image(done))).collect()
    };
    [of(&|done| &done.gradient), of(&|done| &done.image)]
}

#[test]
fn it_agrees_with_an_even_one() {
    let all = [
        (GAUSSIAN, Method::Auto),
        (BOX, Method::Auto),
        (GAUSSIAN, Method::CarriedFd),
    ];
    for (filter, method) in thinned(2, all) {
        let scene = ball_over_a_floor(filter);
        let [uneven, even] = uneven_and_even(&scene, method);
        let (uneven, even) = (
            runs(&scene, &uneven, 1..1 + RUNS),
            runs(&scene, &even, 1000..1000 + RUNS),
        );
        for (ours, theirs) in uneven.iter().zip(&even) {
            let agreement = Agreement::new(ours, theirs);
            println!("{method:?} {filter:?}: {agreement:.4?}");
            assert!(agreement.bias.error < 0.03, "{agreement:.4?}");
            assert!(agreement.holds(SIGMAS), "{agreement:.4?}");
        }
    }
}

/// Before a box filter crossings stand for pieces of outlines, which reach from one block into
/// another: an outline alone has hardly any noise that could hide it.
#[test]
fn outlines_go_on_over_blocks() {
    let ball = spiky(vec3(0.5, 0.4, 0.4), 0.6, [1.0, 0.85]);
    let (from, to) = (vec3(0.3, -5.0, 3.0), vec3(0.0, 0.0, 0.2));
    let scene = scene(from, to, 50.0, SIZE, BOX)
        .constant_environment(SKY)
        .solid("ball", ball, [0.0; 3]);
    let [uneven, even] = uneven_and_even(&scene, Method::Auto);
    let (uneven, even) = (
        runs(&scene, &uneven, 1..65),
        runs(&scene, &even, 1000..1064),
    );
    let agreement = Agreement::new(&uneven[0], &even[0]);
    println!("{agreement:.4?}");
    assert!(agreement.bias.error < 5e-3, "{agreement:.4?}");
    assert!(agreement.holds(SIGMAS), "{agreement:.4?}");
}

/// A pilot finds where the noise lies, and for about as much work less is left of it.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn it_is_less_noisy() {
    let scene = load("scenes/demo.xml", &[]).expect("a scene");
    let along = direction(&scene, &[("occluder.translation", &[1.0, 0.2, 0.4])]);
    let own = Settings {
        resolution: Some([192, 192]),
        ..settings(&scene, Method::Auto, 64, 1)
    };
    let decided = decide(&scene, &own, &Question::Forward(&along), &Quiet);
    let (settled, pilot) = decided.expect("a decision");
    assert!(settled.noise.is_some(), "{pilot:?}");
    let of = |noise| {
        let done = |seed| {
            let own = Settings {
                seed,
                spp: 16,
                noise: Option::clone(noise),
                ..settled.clone()
            };
            forward(&scene, &own, &along, &Quiet).expect("a gradient")
        };
        let runs: Vec<_> = (1..5).map(done).collect();
        let rays = runs.iter().flat_map(|run| run.statistics.rays.values());
        let rays: u64 = rays.sum();
        let images: Vec<_> = runs.iter().map(|run| flat(&run.gradient)).collect();
        (variance_of(&images), rays as f64)
    };
    let (uneven, even) = (of(&settled.noise), of(&None));
    println!("{uneven:.4?} {even:.4?} {:?}", pilot.uneven);
    assert!(uneven.0 < even.0 / 1.3, "{uneven:?} {even:?}");
    assert!(uneven.1 < 1.2 * even.1, "{uneven:?} {even:?}");
}

/// What samples an objective's derivative unevenly is not taken for both sides together, which have
/// to have the same random numbers whatever the objective is.
#[test]
fn both_sides_together_are_even() {
    let scene = load("scenes/demo.xml", &[]).expect("a scene");
    let keys = all_parameters(&scene).into_iter();
    let keys: Vec<_> = keys
        .filter(|p| p.key == "occluder.vertex_positions")
        .collect();
    let own = Settings {
        resolution: Some([96, 96]),
        ..settings(&scene, Method::Auto, 64, 1)
    };
    let prepared = prepared(&scene);
    let decided = |question| prepared.decide(&own, &question, &Quiet).expect("an answer");
    let (backward, _) = decided(Question::Backward(&keys));
    assert!(backward.noise.is_some());
    let (both, _) = decided(Question::ForwardAndBackward(&keys));
    assert!(both.noise.is_none());
}

/// The variance between runs, summed over all numbers.
fn variance_of(runs: &[Vec<f64>]) -> f64 {
    let count = runs.len() as f64;
    let of_number = |i: usize| {
        let mean = runs.iter().map(|r| r[i]).sum::<f64>() / count;
        runs.iter().map(|r| (r[i] - mean).powi(2)).sum::<f64>() / (count - 1.0)
    };
    (0..runs[0].len()).map(of_number).sum()
}

/// Where all pixels count as much, reverse mode samples as forward mode does.
#[test]
fn it_is_transposed() {
    let scene = ball_over_a_floor(GAUSSIAN);
    let [own, _] = uneven_and_even(&scene, Method::Auto);
    let mut random = Random::new(5);
    let mut sign = || if random.unit() < 0.5 { -1.0 } else { 1.0 };
    let pixels = (0..SIZE[0] * SIZE[1])
        .map(|_| [sign(), sign(), sign()])
        .collect();
    let weight = Image {
        width: SIZE[0] as usize,
        height: SIZE[1] as usize,
        pixels,
    };
    let sides = both_sides_by(&prepared(&scene), &along(&scene), &weight, own);
    assert!(sides.allowed > 0.0);
    assert_eq!(difference("ball", &sides), None);
}

/// Whether a gradient is the same on one thread and on several.
#[test]
fn threads_do_not_matter() {
    let scene = ball_over_a_floor(GAUSSIAN);
    let [own, _] = uneven_and_even(&scene, Method::Auto);
    let with = |threads| {
        let own = Settings {
            threads,
            ..own.clone()
        };
        let done = forward(&scene, &own, &along(&scene), &Quiet).expect("a gradient");
        [done.gradient, done.image].map(|image| flat(&image))
    };
    assert!(with(1) == with(3));
}
