//! Reverse mode by differences: a number's derivative is the image's along it, weighed.

use crate::carried_differences::{metal, near_metal};
use common::comparison::small_floor;
use common::scenes::*;
use common::shapes::Random;
use common::transposition::{both_sides_by, difference, prepared, random_weight};
use common::{Quiet, direction, pull_back, settings};
use glam::vec3;
use warpath::methods::{self, Method, Objective, Question, Settings, decide};
use warpath::scene::Scene;
use warpath::scene::parameters::{self, Parameter};

const COLOUR: &str = "floor.bsdf.reflectance.value";

fn find(scene: &Scene, keys: &[&str]) -> Vec<Parameter> {
    let of = |key: &&str| parameters::find(scene, key).expect("a key");
    keys.iter().map(of).collect()
}

#[test]
fn numbers_are_differences_along_them() {
    let scene = metal();
    let mut random = Random::new(7);
    let weight = random_weight(&mut random, &scene);
    let prepared = prepared(&scene);
    let moved: [(&str, &[f32]); 4] = [
        ("thing.translation", &[0.0, 1.0, 0.0]),
        ("cam.rotation", &[0.0, 0.0, 1.0]),
        ("cam.x_fov", &[1.0]),
        (COLOUR, &[0.0, 1.0, 0.0]),
    ];
    let mut wrong = Vec::new();
    for method in [Method::Fd, Method::CarriedFd] {
        for (key, one) in moved {
            let along = direction(&scene, &[(key, one)]);
            let settings = settings(&scene, method, 16, 4);
            let sides = both_sides_by(&prepared, &along, &weight, settings);
            assert!(sides.forward != 0.0, "{key}: nothing changes");
            wrong.extend(difference(key, &sides));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The mean of the groups is the gradient, and a group that is done alone is that of all.
#[test]
fn groups_are_parts() {
    let scene = metal();
    let weight = random_weight(&mut Random::new(3), &scene);
    let wanted = find(&scene, &["thing.scale", "cam.x_fov"]);
    let settings = Settings {
        groups: Some(methods::Groups {
            count: 4,
            only: None,
        }),
        ..settings(&scene, Method::CarriedFd, 8, 2)
    };
    let run = |settings: &Settings| {
        let objective = Objective::Adjoint(&weight);
        methods::backward(&scene, settings, &wanted, &objective, &Quiet).expect("a gradient")
    };
    let all = run(&settings);
    for parameter in &wanted {
        let groups: Vec<f32> = all
            .groups
            .iter()
            .map(|g| g.by(&scene, parameter)[0])
            .collect();
        assert_eq!(groups.len(), 4);
        let mean = groups.iter().map(|g| f64::from(*g)).sum::<f64>() / 4.0;
        let found = f64::from(all.gradient.by(&scene, parameter)[0]);
        assert!((mean - found).abs() <= 1e-6 * mean.abs(), "{mean} {found}");
        let mut alone = settings.clone();
        alone.groups = Some(methods::Groups {
            count: 4,
            only: Some(2),
        });
        let one = run(&alone);
        assert_eq!(one.groups.len(), 1);
        assert_eq!(one.groups[0].by(&scene, parameter), [groups[2]]);
    }
}

/// Before smooth metal `auto` takes differences for what moves, if that is few numbers, and paths
/// for the rest in one pass.
#[test]
fn auto_takes_them_for_few_numbers() {
    let scene = near_metal();
    let own = settings(&scene, Method::Auto, 64, 3);
    let few = find(&scene, &["cam.translation", COLOUR]);
    let (settled, pilot) =
        decide(&scene, &own, &Question::Backward(&few), &Quiet).expect("a decision");
    assert_eq!(settled.method, Method::CarriedFd, "{pilot:?}");
    let weight = random_weight(&mut Random::new(5), &scene);
    let found = pull_back(&scene, &settled, &few, &weight);
    // Of the same random numbers.
    let [moved, coloured] = [Method::CarriedFd, Method::Reparam].map(|method| Settings {
        method,
        ..own.clone()
    });
    assert_eq!(found[0], pull_back(&scene, &moved, &few[..1], &weight)[0]);
    assert_eq!(
        found[1],
        pull_back(&scene, &coloured, &few[1..], &weight)[0]
    );

    let many = find(&scene, &["thing.vertex_positions"]);
    let (settled, _) =
        decide(&scene, &own, &Question::Backward(&many), &Quiet).expect("a decision");
    assert!(settled.method == Method::Auto && settled.is_decided());
    // What is to be the transpose of forward mode goes along paths.
    let both = Question::ForwardAndBackward(&few);
    let (settled, _) = decide(&scene, &own, &both, &Quiet).expect("a decision");
    assert_eq!(settled.method, Method::Auto);
}

#[test]
fn too_many_numbers_are_refused() {
    let fine = ball(5, vec3(0.0, 0.0, 0.4), 0.4);
    let scene = small_floor().smooth("thing", fine, [0.8; 3]);
    let many = find(&scene, &["thing.vertex_positions"]);
    let weight = random_weight(&mut Random::new(5), &scene);
    let settings = settings(&scene, Method::Fd, 1, 3);
    let objective = Objective::Adjoint(&weight);
    let refused = methods::backward(&scene, &settings, &many, &objective, &Quiet);
    let sentence = refused.expect_err("a refusal").to_string();
    assert!(sentence.contains("one for each of"), "{sentence}");
}

/// The last row of a matrix stays, and a key that is asked for twice is told twice.
#[test]
fn matrices_keep_their_last_row() {
    let scene = metal();
    let weight = random_weight(&mut Random::new(5), &scene);
    let settings = settings(&scene, Method::CarriedFd, 4, 3);
    let wanted = find(
        &scene,
        &["thing.to_world", "thing.to_world", "thing.translation"],
    );
    let found = pull_back(&scene, &settings, &wanted, &weight);
    assert_eq!(found[0], found[1]);
    assert_eq!(found[0].len(), 16);
    assert_eq!(found[0][12..], [0.0; 4]);
    // The last column is a translation.
    for (row, slope) in found[2].iter().enumerate() {
        let same = found[0][4 * row + 3];
        assert!(
            *slope != 0.0 && (same - slope).abs() <= 2e-3 * slope.abs(),
            "{same} {slope}"
        );
    }
}

/// By a loss the image and its value are those of the evaluation.
#[test]
fn losses_are_evaluated_once() {
    let scene = metal();
    let target = random_weight(&mut Random::new(5), &scene);
    let wanted = find(&scene, &["cam.x_fov"]);
    let runs = [Method::CarriedFd, Method::Reparam].map(|method| {
        let settings = settings(&scene, method, 4, 3);
        let objective = Objective::L2(&target);
        methods::backward(&scene, &settings, &wanted, &objective, &Quiet).expect("a gradient")
    });
    assert_eq!(runs[0].loss, runs[1].loss);
    assert_eq!(runs[0].image.pixels, runs[1].image.pixels);
    assert!(runs[0].gradient.by(&scene, &wanted[0])[0] != 0.0);
}
