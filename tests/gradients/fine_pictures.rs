//! Pictures whose detail is finer than a pixel, on things that move: the film follows those of
//! colours, and over those that turn normals directions rest.

use common::comparison::{Interior::Fails, check_to, lit, thinned};
use common::materials::Paint;
use common::scenes::*;
use common::transposition::transposed;
use common::{direction, noise_ratios, variance};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Distribution::Ggx;
use warpath::scene::{Filter, Scene};

const MOVED: [(&str, &[f32]); 1] = [("thing.translation", &[1.0, 0.3, 0.2])];

const AT: Vec3 = vec3(0.0, 0.0, 0.4);

/// A thing on a floor.
fn above_a_floor(filter: Filter) -> Scene {
    let from = vec3(0.3, -3.4, 1.9);
    let scene = scene(from, AT, 20.0, [12; 2], filter);
    lit(scene.solid("floor", floor(0.8, 0.0), [0.6, 0.5, 0.4])).depth(4)
}

/// The picture on the thing, so many times as fine.
fn fine(mut scene: Scene, by: f32) -> Scene {
    let thing = scene.meshes.iter_mut().find(|m| m.id == "thing");
    for uv in &mut thing.expect("a mesh").uvs {
        *uv *= by;
    }
    scene
}

fn coloured(filter: Filter) -> Scene {
    let ball = ball(3, AT, 0.4);
    fine(
        above_a_floor(filter)
            .smooth("thing", ball, [0.8; 3])
            .picture("thing"),
        16.0,
    )
}

#[test]
fn of_colours() {
    check_to(0.03, &coloured(GAUSSIAN), &MOVED, 256, None, Fails);
}

#[test]
fn transposition() {
    let black = "thing.bsdf.brdf_0.reflectance.value";
    transposed(&coloured(GAUSSIAN), Method::Reparam, &[black]);
}

/// Over a filter that jumps the film cannot follow anything, which tells what following is worth.
#[test]
fn following_is_less_noise() {
    let [box_filter, smooth] = [BOX, GAUSSIAN].map(coloured);
    let ratio = noise_ratios([&box_filter, &smooth], &MOVED, [1..7, 7..13]);
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| *r > 10.0), "{ratio:?}");
}

/// Light goes back and forth between spikes: lobes that turned with the normals would turn by many
/// times as much at every bounce.
#[test]
fn of_normals() {
    for bumps in [None, Some(0.003)] {
        let paints = [
            (|s| s) as fn(Scene) -> Scene,
            |s| s.metal("thing", 0.3, Ggx),
            |s| s.plastic("thing", Some(0.2)),
            |s| s.layers("thing", 0.2),
        ];
        for paint in thinned(2, paints) {
            let spikes = spiky(AT, 0.4, [1.0, 0.5]);
            let scene = paint(above_a_floor(GAUSSIAN).solid("thing", spikes, [0.8; 3]));
            let scene = fine(scene.relief("thing", bumps), 64.0);
            let along = direction(&scene, &MOVED);
            let [ours, differences] = [Method::Reparam, Method::Fd]
                .map(|method| variance(&scene, (method, 64), &along, 0..8));
            println!("{bumps:?}: {ours} {differences}");
            assert!(ours < differences, "{bumps:?}: {ours} {differences}");
        }
    }
}
