//! Sheets that lie on a table: how near their edges are to what they shade has no lower bound.

use common::comparison::{Interior::Fails, check_to};
use common::scenes::*;
use common::transposition::transposed;
use common::{Quiet, direction, noise_ratios, settings};
use glam::vec3;
use warpath::methods::{Method, Settings, forward};
use warpath::scene::{Filter, Scene};

const MOVED: [(&str, &[f32]); 1] = [("sheet.translation", &[1.0, 0.0, 0.0])];

fn in_the_dark(gap: f32, filter: Filter) -> Scene {
    let sheet = parallelogram(
        vec3(-0.34, -0.62, gap),
        vec3(0.96, 0.29, 0.0),
        vec3(-0.29, 0.96, 0.0),
    );
    let from = vec3(0.5, -4.0, 3.0);
    scene(from, vec3(0.0, 0.0, 0.0), 30.0, [16; 2], filter)
        .solid("table", floor(2.0, 0.0), [0.7, 0.2, 0.1])
        .solid("sheet", sheet, [0.25, 0.4, 0.6])
        .depth(2)
}

fn on_a_table(gap: f32, filter: Filter) -> Scene {
    let lamp = ceiling(vec3(0.7, 0.0, 2.0), 1.0);
    in_the_dark(gap, filter).light("lamp", lamp, [3.0; 3])
}

#[test]
fn gradients() {
    check_to(0.02, &on_a_table(1e-4, GAUSSIAN), &MOVED, 1024, None, Fails);
}

#[test]
fn transposition() {
    let idle = ["lamp.bsdf.brdf_0.reflectance.value"];
    transposed(&on_a_table(1e-3, GAUSSIAN), Method::Reparam, &idle);
}

/// Nothing drifts over a filter that jumps, so that samples lie beside the sheet's edge, nearer
/// than it is high. What lies a thousandth of a line past an edge so near may still be hidden by
/// it, in single precision: half of the contact shadow's part was lost there.
#[test]
fn nothing_is_lost_beside_the_edge() {
    let round = ball(3, vec3(0.7, 0.0, 1.5), 0.4);
    let under_round = in_the_dark(1e-3, BOX).light("lamp", round, [9.0; 3]);
    for scene in [on_a_table(1e-3, BOX), under_round] {
        let along = direction(&scene, &MOVED);
        let settings = settings(&scene, Method::Reparam, 4096, 1);
        let found = forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
        assert_eq!(found.statistics.rejected.get("silhouette_not_found"), None);
    }
}

/// Which tells, too, what following is worth.
#[test]
fn following_is_less_noise() {
    let [box_filter, smooth] = [BOX, GAUSSIAN].map(|filter| on_a_table(1e-4, filter));
    let ratio = noise_ratios([&box_filter, &smooth], &MOVED, [1..33, 33..65]);
    println!("{ratio:?}");
    assert!(ratio.iter().all(|r| *r > 4.0), "{ratio:?}");
}

/// What a film at rest has most of its noise from no pilot meets: it would seem to have a hundred
/// times the efficiency, and have five times the error.
#[test]
fn no_pilot_lets_the_film_rest() {
    let scene = on_a_table(1e-4, GAUSSIAN);
    let settings = Settings {
        resolution: Some([64; 2]),
        ..settings(&scene, Method::Auto, 64, 1)
    };
    let along = direction(&scene, &MOVED);
    let found = forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
    let trials = found.statistics.pilot.expect("a pilot").trials;
    let ways: Vec<&str> = trials.iter().map(|trial| trial.way.as_str()).collect();
    let usual = "cells on the film, cells over lobes";
    assert_eq!(ways, [usual, "carried finite differences"]);
}
