//! Bodies through which the floor is seen that they stand on: their undersides lie in its plane,
//! and which of the two a ray meets is chance.

use common::comparison::{Interior::Fails, Runs, SIGMAS, SKY, check_to, compared};
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use common::{Quiet, direction, dot, gradient, loses_nothing, runs, settings};
use glam::{Vec3, vec3};
use warpath::methods::{Method, forward};
use warpath::scene::{DeltaLightKind, Scene};

const HALF: f32 = 0.5;

/// A block of glass on a floor before the sky, `gap` above it.
fn block_of_glass(gap: f32) -> Scene {
    let block = placed(
        cuboid(vec3(HALF, HALF, HALF)),
        vec3(0.0, 0.0, 25.0),
        vec3(0.1, 0.2, HALF + gap),
    );
    let from = vec3(0.3, -4.0, 3.0);
    scene(from, vec3(0.0, 0.0, 0.3), 30.0, [16; 2], GAUSSIAN)
        .solid("floor", floor(2.0, 0.0), [0.7, 0.2, 0.1])
        .solid("block", block, [0.5; 3])
        .constant_environment(SKY)
        .depth(5)
        .clear("block")
}

const MOVED: [(&str, &[f32]); 1] = [("cam.translation", &[1.0, 0.5, 0.2])];

#[test]
fn transposition() {
    transposed(
        &block_of_glass(0.0),
        Method::Reparam,
        &["block.bsdf.brdf_0.reflectance.value"],
    );
}

/// The camera moves, and nothing jumps that lies in one plane.
#[test]
fn gradients() {
    check_to(0.02, &block_of_glass(0.0), &MOVED, 1024, None, Fails);
}

/// Lifted, all of a plane would be seen otherwise at once: that is no gradient, and no number of
/// fourteen digits.
#[test]
fn what_is_lifted_changes_by_no_more_than_what_hangs() {
    let [stands, hangs] = [0.0, 0.01].map(|gap| {
        let scene = block_of_glass(gap);
        let along = direction(&scene, &[("block.translation", &[0.0, 0.0, 1.0])]);
        let settings = settings(&scene, Method::Reparam, 256, 1);
        let found = gradient(&scene, &settings, &along);
        dot(&found, &found).sqrt()
    });
    println!("{stands} {hangs}");
    assert!(stands < 10.0 * hangs, "{stands} {hangs}");
}

/// What is not followed is said.
#[test]
fn surfaces_that_coincide_are_counted() {
    let counted = [0.0, 0.01].map(|gap| {
        let scene = block_of_glass(gap);
        let along = direction(&scene, &MOVED);
        let settings = settings(&scene, Method::Reparam, 64, 1);
        let found = forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
        let rejected = found.statistics.rejected;
        ["surfaces_coincide", "silhouette_not_found"]
            .map(|cause| rejected.get(cause).copied().unwrap_or(0))
    });
    println!("{counted:?}");
    assert!(counted[0][0] > 0 && counted[1][0] == 0, "{counted:?}");
}

/// Of rough glass under a sun, seen from inside: the shadow on the underside ends with it, where
/// the sides begin, which the floor does not hide from the sun.
#[test]
fn shadows_on_what_stands_end_with_it() {
    let scene = block_of_glass(0.0).glass("block", 0.2).delta_light(
        "sun",
        DeltaLightKind::Directional {
            direction: vec3(-0.5, 0.6, -1.0),
        },
        [1.5, 1.4, 1.2],
    );
    let along = direction(&scene, &MOVED);
    loses_nothing(&scene, &settings(&scene, Method::Reparam, 64, 1), &along);
}

/// Runs of a scene by what moves, of which the first has this seed.
fn runs_of(
    scene: Scene,
    moved: (&str, &[f32]),
    method: Method,
    first: u64,
) -> impl Fn(u32) -> Vec<Vec<f64>> {
    let along = direction(&scene, &[moved]);
    move |spp| runs(&scene, (method, spp), &along, first..first + 12)
}

fn agree(runs: [Runs; 2]) {
    let found = compared(128, 0.02, runs).agreement;
    assert!(found.holds(SIGMAS), "{found:.4?}");
}

/// A block on a floor under a lamp, `depth` in it.
fn pressed_in(depth: f32) -> Scene {
    let block = placed(
        cuboid(vec3(HALF, HALF, HALF)),
        vec3(0.0, 0.0, 25.0),
        vec3(0.1, 0.2, HALF - depth),
    );
    let from = vec3(0.3, -4.0, 3.0);
    scene(from, vec3(0.0, 0.0, 0.3), 30.0, [16; 2], GAUSSIAN)
        .solid("floor", floor(2.0, 0.0), [0.7, 0.2, 0.1])
        .solid("block", block, [0.2, 0.4, 0.6])
        .light("lamp", ceiling(vec3(-1.5, -1.5, 3.5), 0.7), [12.0; 3])
        .constant_environment(SKY)
        .depth(3)
}

/// The lower edges of what stands on a floor are where its sides meet the floor, as they are of
/// what stands in it.
#[test]
fn what_stands_is_what_is_pressed_in() {
    let lifted: (&str, &[f32]) = ("block.translation", &[0.0, 0.0, 1.0]);
    let tilted: (&str, &[f32]) = ("block.rotation", &[1.0, 0.4, 0.0]);
    let floor_tilted: (&str, &[f32]) = ("floor.rotation", &[1.0, 0.4, 0.0]);
    for moved in [lifted, tilted, floor_tilted] {
        let in_it = runs_of(pressed_in(2e-4), moved, Method::Reparam, 1000);
        for (method, depth) in [(Method::Reparam, 2e-5), (Method::Edges, 0.0)] {
            println!("{method:?} {depth} {}", moved.0);
            agree([&runs_of(pressed_in(depth), moved, method, 1), &in_it]);
        }
    }
}

/// Floor and walls of a room, which go on beyond its corner by `beyond`.
fn corner(beyond: f32) -> Scene {
    let length = 2.0 + beyond;
    let wall = |corner: Vec3, along: Vec3| {
        parallelogram(corner - Vec3::Z * beyond, along * length, Vec3::Z * length)
    };
    let ground = parallelogram(vec3(-1.0, -1.0, 0.0), Vec3::X * length, Vec3::Y * length);
    let from = vec3(-0.3, -4.0, 1.5);
    scene(from, vec3(0.95, 0.75, 0.25), 14.0, [16; 2], GAUSSIAN)
        .solid("floor", ground, [0.7, 0.6, 0.5])
        .solid("back", wall(vec3(-1.0, 1.0, 0.0), Vec3::X), [0.6, 0.6, 0.7])
        .solid("side", wall(vec3(1.0, -1.0, 0.0), Vec3::Y), [0.2, 0.5, 0.3])
        .light("lamp", ceiling(vec3(-0.2, 0.0, 1.9), 0.3), [12.0; 3])
        .constant_environment([0.2; 3])
        .depth(3)
}

/// Where walls and floor end along one line the border is where they would pass through each other.
#[test]
fn walls_that_meet_at_their_rims_are_walls_that_go_on() {
    let moved: [(&str, &[f32]); 2] = [
        ("side.translation", &[1.0, 0.0, 0.0]),
        ("floor.translation", &[0.0, 0.0, 1.0]),
    ];
    for moved in moved {
        let go_on = runs_of(corner(0.3), moved, Method::Reparam, 1000);
        for method in [Method::Reparam, Method::Edges] {
            println!("{method:?} {}", moved.0);
            agree([&runs_of(corner(0.0), moved, method, 1), &go_on]);
        }
    }
}
