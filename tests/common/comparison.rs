//! `reparam` against finite differences, and the scenes it is done on.

use super::compared::{Compared, agreement};
pub use super::compared::{Runs, compared, with_samples};
use super::scenes::*;
use super::shapes::{Random, Shape, soup};
use super::{differences, direction, gradient, settings};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{Filter, Scene};

/// Independent runs of each method.
const RUNS: u64 = 12;
/// How far from the truth a right answer may be.
pub const SIGMAS: f64 = 4.0;
/// The largest standard error of the gradient's size that still means something.
pub const RESOLUTION: f64 = 0.02;

/// What cannot be told with some samples is tried with so many times as many.
const MORE: u32 = 4;

/// Radiance of the sky.
pub const SKY: [f32; 3] = [0.7, 0.8, 1.0];

/// What `interior` must do.
#[derive(PartialEq)]
pub enum Interior {
    /// Be wrong.
    Fails,
    /// Be right: nothing moves that hides anything.
    Agrees,
}

/// Holds `reparam` with up to `spp` samples to differences with four times as many (of steps of
/// `step`, or the engine's own).
pub fn check(
    scene: &Scene,
    parts: &[(&str, &[f32])],
    spp: u32,
    step: Option<f64>,
    interior: Interior,
) {
    check_to(RESOLUTION, scene, parts, spp, step, interior);
}

/// As [`check`], where differences are so noisy that standard errors up to `resolution` of the
/// gradient must do.
pub fn check_to(
    resolution: f64,
    scene: &Scene,
    parts: &[(&str, &[f32])],
    spp: u32,
    step: Option<f64>,
    interior: Interior,
) {
    let along = direction(scene, parts);
    let runs = |method: Method, spp: u32, first_seed: u64| -> Vec<Vec<f64>> {
        let seeds = first_seed..first_seed + RUNS;
        seeds
            .map(|seed| match (method, step) {
                (Method::Fd, Some(h)) => {
                    differences(scene, &settings(scene, method, spp, seed), &along, h)
                }
                _ => gradient(scene, &settings(scene, method, spp, seed), &along),
            })
            .collect()
    };
    let ours = |spp| runs(Method::Reparam, spp, 1);
    let theirs = |spp| runs(Method::Fd, 4 * spp, 1000);
    let holds = |found: &Compared| {
        let found = found.agreement;
        assert!(found.holds(SIGMAS), "reparam is off: {found:.4?}");
    };
    let naive = |found: &Compared| {
        let interior = runs(Method::Interior, found.samples[0], 1);
        let naive = agreement(&interior, &found.theirs);
        println!("interior {naive:.4?}");
        naive.holds(SIGMAS)
    };
    let mut found = compared(spp, resolution, [&ours, &theirs]);
    holds(&found);
    let mut agrees = naive(&found);
    // What suffices to measure a gradient's size need not to tell what it lacks.
    while agrees && interior == Interior::Fails && found.samples != [spp; 2] {
        let more = found.samples.map(|samples| (MORE * samples).min(spp));
        found = found.with(more, [&ours, &theirs]);
        holds(&found);
        agrees = naive(&found);
    }
    assert_eq!(agrees, interior == Interior::Agrees, "interior");
}

/// All of a list by `make test-long`, and by `make test` the first and then one in `every`: of what
/// takes long and shows once more, with another material, say, what others have shown.
pub fn thinned<T>(every: usize, all: impl IntoIterator<Item = T>) -> impl Iterator<Item = T> {
    let every = if cfg!(feature = "all-samples") {
        1
    } else {
        every
    };
    all.into_iter().step_by(every)
}

/// A floor that waits for a light.
pub fn floor_seen(size: u32, filter: Filter) -> Scene {
    scene(
        vec3(0.3, -3.4, 1.9),
        vec3(0.0, 0.0, 0.1),
        38.0,
        [size; 2],
        filter,
    )
    .solid("floor", floor(2.0, 0.0), [0.6, 0.5, 0.4])
}

/// A lamp that no direction in the scenes is symmetric to.
pub fn lit(scene: Scene) -> Scene {
    let shape = placed(
        ceiling(Vec3::ZERO, 0.45),
        vec3(7.0, -5.0, 13.0),
        vec3(0.2, 0.1, 2.2),
    );
    scene.light("lamp", shape, [8.0, 7.0, 6.0])
}

/// A block askew above the floor.
pub fn block() -> Shape {
    placed(
        cuboid(vec3(0.35, 0.2, 0.12)),
        vec3(12.0, 25.0, 33.0),
        vec3(0.1, 0.0, 0.75),
    )
}

/// A block that throws a soft shadow on a floor.
pub fn shadow() -> Scene {
    lit(floor_seen(20, GAUSSIAN).solid("block", block(), [0.3, 0.6, 0.5]))
}

/// A small floor, seen from near.
pub fn small_floor() -> Scene {
    scene(
        vec3(0.3, -3.4, 1.9),
        vec3(0.0, 0.0, 0.2),
        26.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(0.8, 0.0), [0.6, 0.5, 0.4])
}

/// A block and a floor behind a ball that hides most of them.
pub fn behind_a_ball() -> Scene {
    scene(
        vec3(0.3, -3.4, 1.9),
        vec3(0.0, 0.3, 0.4),
        18.0,
        [16; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(1.6, 0.0), [0.6, 0.5, 0.4])
    .solid("block", block(), [0.3, 0.6, 0.5])
    .smooth("ball", ball(3, vec3(0.1, -0.5, 0.45), 0.4), [0.5; 3])
    .depth(4)
}

/// A big block close to it.
pub fn close_up() -> Scene {
    let big = placed(
        cuboid(vec3(0.6, 0.5, 0.2)),
        vec3(12.0, 25.0, 33.0),
        vec3(0.1, 0.0, 0.6),
    );
    small_floor().solid("block", big, [0.3, 0.6, 0.5])
}

/// Leaves strewn over it, under the sky.
pub fn foliage() -> Scene {
    let (positions, triangles) = soup(&mut Random::new(3), 40, 0.35);
    let over_floor = |p: Vec3| p * vec3(0.6, 0.6, 0.2) + vec3(0.0, 0.0, 0.3);
    let leaves = (positions.into_iter().map(over_floor).collect(), triangles);
    small_floor()
        .solid("leaves", leaves, [0.2, 0.6, 0.1])
        .constant_environment(SKY)
}

/// The same before a coloured wall.
pub fn room(depth: u32) -> Scene {
    let wall = parallelogram(
        vec3(-0.9, 0.9, -0.1),
        vec3(1.8, 0.0, 0.0),
        vec3(0.0, 0.0, 1.6),
    );
    lit(close_up())
        .depth(depth)
        .solid("wall", wall, [0.8, 0.2, 0.1])
}

/// A block before the sky.
pub fn silhouette(filter: Filter) -> Scene {
    let shape = placed(
        cuboid(vec3(0.5, 0.3, 0.4)),
        vec3(12.0, 25.0, 33.0),
        Vec3::ZERO,
    );
    scene(vec3(0.3, -4.0, 0.5), Vec3::ZERO, 26.0, [20; 2], filter)
        .constant_environment(SKY)
        .solid("block", shape, [0.3, 0.5, 0.2])
}
