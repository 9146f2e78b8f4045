//! `auto`: what its pilot may come to is right, and it comes to the same every time.

use crate::carried_differences::near_metal;
use common::comparison::*;
use common::materials::*;
use common::scenes::*;
use common::shapes::{Random, soup};
use common::transposition::{
    all_parameters, both_sides_by, difference, prepared, random_values, random_weight,
};
use common::{Direction, Quiet, direction, flat, gradient, settings, variance};
use glam::{Affine2, Mat3, Vec3, vec2, vec3};
use warpath::methods::{
    Constants, Method, Mixture, OnFilm, OverLobes, Pilot, Prepared, Question, Settings, decide,
    forward,
};
use warpath::scene::{Beam, BeamProfile, DeltaLightKind, Distribution, Layout, Scene, load};
use warpath::statistics::agreement::Agreement;

/// Independent runs of each.
const RUNS: u64 = 16;
const SIGMAS: f64 = 4.0;

/// So often that the smallest job is worth a pilot that sees enough.
const OFTEN: u64 = 100_000;

const MOVED: [f32; 3] = [1.0, 0.2, 0.4];

fn mixtures() -> impl Iterator<Item = Mixture> {
    let films = [
        OnFilm::Drifting,
        OnFilm::Resting,
        OnFilm::WithAll,
        OnFilm::Edges,
    ];
    let lobes = [OverLobes::Cells, OverLobes::EdgesFromRest];
    let of_film = move |film| lobes.map(|lobes| Mixture { film, lobes });
    let of_films = films.into_iter().flat_map(of_film).skip(1);
    of_films.chain([WITH_FEW_LINES])
}

const WITH_FEW_LINES: Mixture = Mixture {
    film: OnFilm::Drifting,
    lobes: OverLobes::SeldomCells,
};

const FROM_REST: Mixture = Mixture {
    film: OnFilm::Drifting,
    lobes: OverLobes::EdgesFromRest,
};

fn by(scene: &Scene, mixture: Mixture, spp: u32, seed: u64) -> Settings {
    Settings {
        constants: Constants {
            mixture: Some(mixture),
            ..Constants::default()
        },
        ..settings(scene, Method::Auto, spp, seed)
    }
}

/// A film that drifts, over things that shade each other under the sky.
fn leaves() -> Scene {
    foliage()
}

#[test]
fn all_are_right() {
    let scene = leaves();
    let along = direction(&scene, &[("cam.translation", &MOVED)]);
    agree_with_the_usual(&scene, &along, mixtures());
}

/// What the box hides over lobes is a fifth of the gradient, pixel by pixel.
#[test]
fn few_lines_are_enough() {
    let mut scene = load("scenes/indirect.xml", &[]).expect("a scene");
    let film = &mut scene.sensors[0].film;
    (film.width, film.height, film.crop_size) = (12, 12, [12; 2]);
    let along = direction(&scene, &[("box.translation", &MOVED)]);
    agree_with_the_usual(&scene, &along, [WITH_FEW_LINES]);
}

/// What the film's drift brings of a caustic is taken off by relays ([`crate::relays`]).
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn a_film_that_follows_all_sees_caustics_right() {
    let scene = crate::relays::caustic();
    let along = direction(&scene, &[("ball.translation", &MOVED)]);
    let with_all = Mixture {
        film: OnFilm::WithAll,
        lobes: OverLobes::Cells,
    };
    agree_with_the_usual(&scene, &along, [with_all]);
}

/// Holds mixtures to `reparam`.
fn agree_with_the_usual(
    scene: &Scene,
    along: &Direction,
    mixtures: impl IntoIterator<Item = Mixture>,
) {
    let runs = |own: &dyn Fn(u64) -> Settings, first: u64| -> Vec<Vec<f64>> {
        let seeds = first..first + RUNS;
        seeds
            .map(|seed| gradient(scene, &own(seed), along))
            .collect()
    };
    let usual = runs(&|seed| settings(scene, Method::Reparam, 256, seed), 1);
    for mixture in mixtures {
        let own = runs(&|seed| by(scene, mixture, 256, seed), 1000);
        let agreement = Agreement::new(&own, &usual);
        println!("{mixture:?}: {agreement:.4?}");
        assert!(agreement.bias.error < 0.05, "{mixture:?}: {agreement:.4?}");
        assert!(agreement.holds(SIGMAS), "{mixture:?}: {agreement:.4?}");
    }
}

#[test]
fn forward_and_backward_are_transposed() {
    let scene = room(3);
    let mut random = Random::new(3);
    let along: Direction = all_parameters(&scene)
        .into_iter()
        .map(|p| (p.clone(), random_values(&mut random, p.len())))
        .collect();
    let weight = random_weight(&mut random, &scene);
    let prepared = prepared(&scene);
    for mixture in mixtures() {
        let sides = both_sides_by(&prepared, &along, &weight, by(&scene, mixture, 32, 4));
        assert_eq!(difference(&format!("{mixture:?}"), &sides), None);
        assert!(
            sides.allowed > 0.0,
            "{mixture:?}: nothing was differentiated"
        );
    }
}

/// A metal floor that shows a lamp between leaves that rest and pass through each other, and a
/// block on which light falls that comes from it.
fn lamp_behind_leaves() -> Scene {
    let below = |p: Vec3| p * vec3(0.5, 0.5, 0.2) + vec3(0.0, 0.3, 1.6);
    let (positions, triangles) = soup(&mut Random::new(5), 40, 0.35);
    let leaves = (positions.into_iter().map(below).collect(), triangles);
    lit(close_up())
        .solid("leaves", leaves, [0.2, 0.6, 0.1])
        .metal("floor", 0.1, Distribution::Ggx)
        .constant_environment([0.3, 0.4, 0.5])
        .depth(4)
}

/// By the motion of a lamp and of a block: edges are drawn for the floor and the leaves, and cells
/// are searched for what the block sees.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn edges_from_rest_are_right_among_things_that_intersect() {
    let scene = lamp_behind_leaves();
    let along = direction(
        &scene,
        &[
            ("lamp.translation", &[0.6, 0.4, 0.3]),
            ("block.translation", &[0.2, 0.3, 0.1]),
        ],
    );
    agree_with_the_usual(&scene, &along, [FROM_REST]);

    // No other edges may be drawn here, and the pilot tries these.
    let edges = forward(
        &scene,
        &settings(&scene, Method::Edges, 4, 1),
        &along,
        &Quiet,
    );
    assert!(edges.is_err());
    let question = Question::Forward(&along);
    let asked = settings(&scene, Method::Auto, 16, 1);
    let decided = prepared(&scene).decide_for(OFTEN, &asked, &question, &Quiet);
    let (_, pilot) = decided.expect("a decision");
    let ways: Vec<&str> = pilot.trials.iter().map(|t| t.way.as_str()).collect();
    let tried = |what: &str| ways.iter().any(|way| way.ends_with(what));
    assert!(tried("edges over lobes of points at rest"), "{ways:?}");
}

#[test]
fn edges_from_rest_are_transposed() {
    let scene = lamp_behind_leaves();
    let mut random = Random::new(4);
    let moved = all_parameters(&scene).into_iter();
    let along: Direction = moved
        .filter(|p| p.key.starts_with("lamp") || p.key.starts_with("block"))
        .map(|p| (p.clone(), random_values(&mut random, p.len())))
        .collect();
    let weight = random_weight(&mut random, &scene);
    let prepared = prepared(&scene);
    let sides = both_sides_by(&prepared, &along, &weight, by(&scene, FROM_REST, 32, 4));
    assert_eq!(difference("from rest", &sides), None);
    assert!(sides.allowed > 0.0, "nothing was differentiated");
}

/// A ball before the sky, which its own lobes see nothing but.
fn ball_in_the_sky() -> Scene {
    scene(
        Vec3::new(0.0, -5.0, 0.0),
        Vec3::ZERO,
        30.0,
        [16, 16],
        GAUSSIAN,
    )
    .depth(3)
    .constant_environment([1.0; 3])
    .solid("ball", ball(3, Vec3::ZERO, 0.8), [0.3, 0.7, 0.2])
}

fn asked(prepared: &Prepared, settings: &Settings, question: &Question) -> (Settings, Pilot) {
    prepared
        .decide(settings, question, &Quiet)
        .expect("a decision")
}

/// Neither the seed nor the threads matter, and who asks again is told the same without a pilot.
#[test]
fn it_comes_to_the_same_every_time() {
    let scene = ball_in_the_sky();
    let along = direction(&scene, &[("ball.translation", &MOVED)]);
    let keys: Vec<_> = along.iter().map(|(p, _)| p.clone()).collect();
    for question in [Question::Forward(&along), Question::Backward(&keys)] {
        let with = |seed, threads| Settings {
            threads,
            ..settings(&scene, Method::Auto, 16, seed)
        };
        let (one, pilot) = decide(&scene, &with(1, 1), &question, &Quiet).expect("a decision");
        assert!(pilot.trials.len() > 1, "{pilot:?}");
        // All vertices move.
        let mut trials = pilot.trials.iter();
        assert!(
            !trials.any(|t| t.way.contains("edges over lobes")),
            "{pilot:?}"
        );
        assert!(!one.needs_pilot());
        let prepared = prepared(&scene);
        for (seed, threads) in [(7, 2), (9, 1)] {
            let (other, again) = asked(&prepared, &with(seed, threads), &question);
            assert_eq!(other.method, one.method);
            assert_eq!(other.constants, one.constants);
            assert_eq!(
                (&again.chosen, &again.trials),
                (&pilot.chosen, &pilot.trials)
            );
            assert_eq!(again.seconds == 0.0, seed == 9, "a pilot was asked again");
        }
    }
}

/// What is done is what would have been done had it been asked for.
#[test]
fn it_does_what_it_says() {
    // A card that covers most of the film: few edges, and long ones.
    let scene = load("scenes/failures/film_border.xml", &[]).expect("a scene");
    let along = direction(&scene, &[("obj.translation", &[1.0, 0.0, 0.3])]);
    let own = settings(&scene, Method::Auto, 1024, 3);
    let done = forward(&scene, &own, &along, &Quiet).expect("a gradient");
    let pilot = done.statistics.pilot.as_ref().expect("a pilot");
    let best = pilot
        .trials
        .iter()
        .filter_map(|t| t.efficiency)
        .fold(0.0, f64::max);
    let chosen = pilot.trials.iter().find(|t| t.way == pilot.chosen);
    assert_eq!(chosen.and_then(|t| t.efficiency), Some(best), "{pilot:?}");
    assert_ne!(pilot.chosen, pilot.trials[0].way, "{pilot:?}");
    let (settled, _) =
        decide(&scene, &own, &Question::Forward(&along), &Quiet).expect("a decision");
    let again = forward(&scene, &settled, &along, &Quiet).expect("a gradient");
    assert_eq!(flat(&done.gradient), flat(&again.gradient));
}

/// A ball over a floor under a lamp.
fn ball_before_the_lamp(subdivisions: u32) -> Scene {
    lit(floor_seen(16, GAUSSIAN)).solid(
        "ball",
        ball(subdivisions, vec3(0.0, 0.0, 0.5), 0.3),
        [0.3, 0.7, 0.2],
    )
}

/// What differences have to do for each vertex that moves counts, whatever is traced.
#[test]
fn displaced_scenes_are_work() {
    let work = |subdivisions: u32| {
        let scene = ball_before_the_lamp(subdivisions);
        let along = direction(&scene, &[("ball.translation", &MOVED)]);
        let own = settings(&scene, Method::Auto, 64, 3);
        let (_, pilot) =
            decide(&scene, &own, &Question::Forward(&along), &Quiet).expect("a decision");
        let carried = Method::CarriedFd.title();
        let mut trials = pilot.trials.iter();
        trials.find(|t| t.way == carried).expect("a trial").work
    };
    let [coarse, fine] = [2, 5].map(work);
    assert!(fine > 1.5 * coarse, "{coarse} {fine}");
}

/// A lamp that is seen in one place has nearly all of the noise.
#[test]
fn the_pilot_sees_all_of_a_small_film() {
    let bright = placed(floor(0.08, 0.0), Vec3::ZERO, vec3(0.7, 0.7, 0.3));
    let sees_lamp = lit(floor_seen(48, GAUSSIAN)).light("bright", bright, [400.0; 3]);
    let along = direction(&sees_lamp, &[("cam.translation", &MOVED)]);
    let own = settings(&sees_lamp, Method::Auto, 64, 3);
    let question = Question::Forward(&along);
    let decided = prepared(&sees_lamp).decide_for(OFTEN, &own, &question, &Quiet);
    let (_, pilot) = decided.expect("a decision");
    let carried = Method::CarriedFd;
    let mut trials = pilot.trials.iter();
    let trial = trials.find(|trial| trial.way == carried.title());
    let seen = trial.expect("a trial of differences").variance;
    let whole = variance(&sees_lamp, (carried, 64), &along, 0..4);
    assert!(seen > 0.5 * whole, "{seen} {whole}");
}

/// Nothing is tried where there is nothing to choose, or where nothing but differences is right.
#[test]
fn it_says_why_nothing_is_tried() {
    let scene = ball_in_the_sky();
    let colour = direction(&scene, &[("ball.bsdf.reflectance.value", &[1.0, 0.5, 0.2])]);
    let own = settings(&scene, Method::Auto, 4, 3);
    let why = |scene: &Scene, along: &Direction| {
        let done = forward(scene, &own, along, &Quiet).expect("a gradient");
        let pilot = done.statistics.pilot.expect("a pilot");
        assert!(pilot.trials.is_empty(), "{pilot:?}");
        (pilot.chosen, pilot.because.expect("a reason"))
    };
    assert_eq!(why(&scene, &colour).1, "nothing that moves has edges");
    let bulb = DeltaLightKind::Point {
        position: vec3(0.0, -2.0, 3.0),
    };
    let mut scene = scene.delta_light("bulb", bulb, [8.0; 3]);
    let profile = BeamProfile::Projector {
        half_tangents: vec2(0.5, 0.5),
        scale: 1.0,
        axis: -Vec3::Z,
    };
    let light = &mut scene.delta_lights[0];
    light.beam = Some(Beam {
        to_local: Mat3::IDENTITY,
        profile,
    });
    let picture = &mut scene.textures[light.power];
    picture.layout = Layout::Checkerboard {
        to_uv: Affine2::IDENTITY,
    };
    picture.texels = vec![[8.0; 3], [1.0; 3]];
    let moved = direction(&scene, &[("ball.translation", &MOVED)]);
    let (chosen, because) = why(&scene, &moved);
    assert_eq!(chosen, Method::CarriedFd.title());
    assert!(because.contains("picture jumps"), "{because}");
    let keys: Vec<_> = moved.iter().map(|(p, _)| p.clone()).collect();
    // So few numbers may have a difference each; paths are asked for by both modes together.
    let (settled, _) = decide(&scene, &own, &Question::Backward(&keys), &Quiet).expect("a way");
    assert_eq!(settled.method, Method::CarriedFd);
    let refused = decide(&scene, &own, &Question::ForwardAndBackward(&keys), &Quiet);
    assert!(refused.is_err(), "{refused:?}");
}

/// A small job is worth a short pilot, and one that is done often a long one.
#[test]
fn pilots_are_as_long_as_their_jobs_are_worth() {
    let scene = near_metal();
    let along = direction(&scene, &[("cam.translation", &MOVED)]);
    let paths = |times: u64| {
        let own = settings(&scene, Method::Auto, 16, 3);
        let question = Question::Forward(&along);
        let decided = prepared(&scene).decide_for(times, &own, &question, &Quiet);
        let trials = decided.expect("a decision").1.trials;
        trials.iter().map(|t| t.paths).collect::<Vec<_>>()
    };
    assert_eq!(paths(1), [1024.0; 2]);
    assert!(paths(OFTEN).iter().all(|n| *n == 16384.0));
}

/// Over a ball with smooth normals, part of which a wall hides, it pays that the film follows all;
/// a look with few of the job's samples of a pixel would not tell.
#[test]
fn films_that_follow_more_are_tried_in_dense_looks() {
    let scene = load("scenes/failures/intersecting.xml", &[]).expect("a scene");
    let along = direction(&scene, &[("obj.translation", &[1.0, 0.0, 0.0])]);
    let pilot = |spp: u32| {
        let own = settings(&scene, Method::Auto, spp, 3);
        let question = Question::Forward(&along);
        let decided = prepared(&scene).decide_for(OFTEN, &own, &question, &Quiet);
        decided.expect("a decision").1
    };
    let follows = |way: &str| way.contains("follows");
    let dense = pilot(64);
    assert!(follows(&dense.chosen), "{dense:?}");
    let sparse = pilot(1024);
    assert!(!sparse.trials.iter().any(|t| follows(&t.way)), "{sparse:?}");
}

/// With more samples differences have shorter steps, and more noise, than a pilot's.
#[test]
fn pilots_count_with_shorter_steps() {
    let scene = near_metal();
    let along = direction(&scene, &[("cam.translation", &MOVED)]);
    // The same look for both: whole, and with as many samples.
    let of_a_sample = |spp: u32| {
        let own = settings(&scene, Method::Auto, spp, 3);
        let question = Question::Forward(&along);
        let decided = prepared(&scene).decide_for(OFTEN, &own, &question, &Quiet);
        let trials = decided.expect("a decision").1.trials;
        let carried = trials.iter().find(|t| t.way == Method::CarriedFd.title());
        carried.expect("a trial").variance * f64::from(spp)
    };
    let ratio = of_a_sample(2048) / of_a_sample(256);
    // The step is shorter by 1.7.
    assert!(ratio > 1.1 && ratio < 8f64.sqrt(), "{ratio}");
}
