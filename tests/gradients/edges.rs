//! `edges` beside `reparam`: two estimators that share nothing but what they look for, so that they
//! agree only if both are right. And `edges` forward beside backward.

use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use common::{Quiet, direction, runs, settings};
use glam::{Vec3, vec3};
use warpath::methods::{Method, forward};
use warpath::scene::{Distribution, Scene};

/// Independent runs of each method.
const RUNS: u64 = 16;
/// How far apart two right answers may be.
const SIGMAS: f64 = 4.0;

/// Holds `edges` to `reparam`, which other tests hold to finite differences, with up to `spp`
/// samples of each; the standard error of the difference is at most this part of the gradient.
fn agree(scene: &Scene, parts: &[(&str, &[f32])], spp: u32, resolution: f64) {
    let along = direction(scene, parts);
    let ours = |spp| runs(scene, (Method::Edges, spp), &along, 1..1 + RUNS);
    let theirs = |spp| runs(scene, (Method::Reparam, spp), &along, 1000..1000 + RUNS);
    let agreement = compared(spp, resolution, [&ours, &theirs]).agreement;
    assert!(agreement.holds(SIGMAS), "{agreement:.4?}");
}

const MOVED: [f32; 3] = [1.0, 0.2, 0.4];

#[test]
fn silhouettes() {
    let scene = silhouette(GAUSSIAN);
    agree(&scene, &[("block.translation", &MOVED)], 64, 0.01);
    agree(&scene, &[("block.rotation", &MOVED)], 64, 0.02);
    agree(&scene, &[("cam.translation", &MOVED)], 64, 0.01);
    // Straight outlines before even light: with few samples of drawn edges the runs have no noise,
    // but for a rare one.
    agree(&silhouette(BOX), &[("block.scale", &[1.0])], 1024, 0.003);
}

/// Two walls whose borders lie on one another: what jumps between them jumps once.
#[test]
fn walls_that_abut() {
    let wall = |x: f32| {
        let up = vec3(0.0, 0.0, 0.6);
        parallelogram(vec3(x, 0.1, 0.1), vec3(0.5, 0.0, 0.0), up)
    };
    let scene = small_floor()
        .solid("west", wall(-0.5), [0.8, 0.2, 0.1])
        .solid("east", wall(0.0), [0.1, 0.3, 0.7])
        .constant_environment(SKY);
    agree(&scene, &[("cam.translation", &MOVED)], 64, 0.01);
    agree(&scene, &[("floor.translation", &MOVED)], 256, 0.02);
}

#[test]
fn shadows() {
    agree(&shadow(), &[("block.translation", &MOVED)], 256, 0.02);
    agree(&shadow(), &[("lamp.translation", &MOVED)], 256, 0.02);
}

/// A flat body whose faces have their own vertices, in a scene without a single shading normal.
#[test]
fn seams_of_flat_bodies() {
    let (torn, _) = torn_apart(block());
    let floor = || floor_seen(20, GAUSSIAN);
    let seamed = lit(floor().solid("block", torn, [0.3, 0.6, 0.5]));
    agree(&seamed, &[("block.translation", &MOVED)], 256, 0.02);
}

/// The ridge of a roof under an even sky, of which a small black card hides a little from one side:
/// nearly everywhere all paths about a piece of the ridge find the same.
#[test]
fn ridges_that_look_alike() {
    let along = |x: f32, z: f32| [vec3(x, -3.0, z), vec3(x, 3.0, z)];
    let corners = [along(-2.0, -1.2), along(0.0, 0.0), along(2.0, -1.2)].concat();
    let roof = (corners, vec![[0, 2, 1], [1, 2, 3], [2, 4, 3], [3, 4, 5]]);
    let card = parallelogram(
        vec3(-2.0, -1.2, 1.4),
        vec3(0.0, 2.4, 0.0),
        vec3(-0.7, 0.0, 1.4),
    );
    let scene = scene(vec3(0.0, -0.5, 4.0), Vec3::ZERO, 16.0, [12, 12], GAUSSIAN)
        .depth(2)
        .solid("roof", roof, [0.8, 0.7, 0.6])
        .solid("card", card, [0.0; 3])
        .constant_environment([1.0; 3]);
    // Paths that see the card are few; without the weights of what is searched for others it would
    // be off by 1.35.
    let moved = [1.0, 0.0, 0.0];
    agree(&scene, &[("roof.translation", &moved)], 1024, 0.25);
}

/// Edges near by, whose far ends are a hundred times as far away.
#[test]
fn contact() {
    let lid = parallelogram(
        vec3(-0.6, -0.5, 0.03),
        vec3(1.2, 0.1, 0.0),
        vec3(0.0, 1.0, 0.0),
    );
    let scene = small_floor()
        .solid("lid", lid, [0.3, 0.6, 0.5])
        .constant_environment(SKY);
    agree(&scene, &[("lid.translation", &[0.0, 0.0, 1.0])], 128, 0.02);
}

#[test]
fn between_surfaces() {
    agree(&room(3), &[("block.translation", &MOVED)], 512, 0.05);
}

#[test]
fn under_a_map() {
    let scene = close_up().sunny();
    agree(&scene, &[("block.translation", &MOVED)], 256, 0.05);
}

#[test]
fn in_a_rough_mirror() {
    let ball = ball(2, vec3(0.1, 0.1, 0.5), 0.35);
    let scene = small_floor()
        .metal("floor", 0.1, Distribution::Ggx)
        .smooth("ball", ball, [0.2, 0.6, 0.3])
        .constant_environment(SKY);
    agree(&scene, &[("ball.translation", &MOVED)], 256, 0.05);
}

/// Black bodies before an even sky: nothing but outlines, which a box cuts into pixels.
#[test]
fn outlines_before_a_box() {
    let seen = || scene(vec3(0.3, -4.0, 1.0), Vec3::ZERO, 24.0, [9, 9], BOX);
    for body in [1, 3].map(|levels| ball(levels, vec3(0.1, 0.0, 0.05), 0.7)) {
        let scene = seen().smooth("body", body, [0.0; 3]);
        let scene = scene.constant_environment(SKY);
        agree(&scene, &[("body.translation", &MOVED)], 512, 0.004);
        agree(&scene, &[("body.rotation", &MOVED)], 512, 0.01);
        agree(&scene, &[("body.scale", &[1.0])], 512, 0.004);
    }
}

/// A coarse ball that turns about its middle: what its facets' horizons bring is about the opposite
/// of what the edges between them do.
#[test]
fn horizons_of_facets() {
    let turning = scene(vec3(0.3, -4.0, 1.0), Vec3::ZERO, 24.0, [12, 12], GAUSSIAN).smooth(
        "ball",
        ball(2, Vec3::ZERO, 0.7),
        [0.3, 0.5, 0.7],
    );
    let turns: [(&str, &[f32]); 1] = [("ball.rotation", &[1.0, 0.5, 0.0])];
    let lamp = ceiling(vec3(-1.0, -1.0, 2.5), 0.4);
    let under_a_lamp = turning.clone().light("lamp", lamp, [30.0; 3]);
    agree(&under_a_lamp, &turns, 256, 0.05);
    agree(&turning.sunny(), &turns, 256, 0.05);
}

/// Triangles thinner than what probes tell apart hang on every third edge of a ball, as scanners
/// leave them: what jumps at such an edge counts once.
#[test]
fn slivers_on_edges() {
    let (mut positions, mut triangles) = ball(2, vec3(0.1, 0.0, 0.05), 0.7);
    for [a, b, _] in triangles.clone().into_iter().step_by(3) {
        let middle = positions[a as usize].midpoint(positions[b as usize]) * (1.0 + 1e-6);
        triangles.push([a, b, positions.len() as u32]);
        positions.push(middle);
    }
    let seen = scene(vec3(0.3, -4.0, 1.0), Vec3::ZERO, 24.0, [12, 12], GAUSSIAN);
    let scene = seen
        .solid("ball", (positions, triangles), [0.3, 0.5, 0.7])
        .light("lamp", ceiling(vec3(-1.0, -1.0, 2.5), 0.4), [30.0; 3]);
    agree(&scene, &[("ball.translation", &MOVED)], 256, 0.05);
}

/// ⟨J·v, w⟩ = ⟨v, Jᵀ·w⟩.
#[test]
fn forward_and_backward_are_transposes() {
    let ball = ball(2, vec3(0.1, 0.1, 1.2), 0.2);
    let scene = room(3)
        .smooth("ball", ball, [0.2, 0.6, 0.3])
        .constant_environment(SKY);
    // A black lamp out of sight: its own colour does not matter.
    transposed(
        &scene,
        Method::Edges,
        &["lamp.bsdf.brdf_0.reflectance.value"],
    );
}

fn refusal(scene: &Scene) -> String {
    let along = direction(scene, &[("block.translation", &MOVED)]);
    let done = forward(scene, &settings(scene, Method::Edges, 4, 1), &along, &Quiet);
    done.err().map(|e| e.to_string()).unwrap_or_default()
}

#[test]
fn what_has_no_edges_is_refused() {
    assert_eq!(refusal(&close_up().constant_environment(SKY)), "");
    let through = placed(cuboid(vec3(0.2, 0.2, 0.2)), Vec3::ZERO, vec3(0.5, 0.0, 0.6));
    let scene = close_up()
        .solid("other", through, [0.5; 3])
        .constant_environment(SKY);
    assert!(refusal(&scene).contains("pass through each other"));
    // What stands on the floor does not pass through it.
    let standing = placed(
        cuboid(vec3(0.05, 0.05, 0.1)),
        Vec3::ZERO,
        vec3(-0.7, -0.7, 0.1),
    );
    let scene = close_up()
        .solid("other", standing, [0.5; 3])
        .constant_environment(SKY);
    assert_eq!(refusal(&scene), "");
    let tiles = close_up().checkerboard("floor").constant_environment(SKY);
    assert!(refusal(&tiles).contains("checkerboard"));
}
