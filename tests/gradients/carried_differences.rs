//! Differences whose samples are carried along with what they see: the same in the mean as those of
//! samples that rest, and less noisy where there are many edges or smooth curved surfaces.

use common::comparison::{RESOLUTION, SIGMAS, SKY, close_up, compared, foliage, small_floor};
use common::materials::Paint;
use common::scenes::*;
use common::{Direction, Quiet, direction, gradient, settings, variance};
use glam::vec3;
use warpath::methods::{Method, Question, Settings, decide, forward};
use warpath::scene::{Scene, load};
use warpath::statistics::agreement::Agreement;

const CAMERA: [(&str, &[f32]); 2] = [
    ("cam.translation", &[1.0, 0.3, 0.2]),
    ("cam.rotation", &[0.1, 0.2, 0.3]),
];

/// A dented ball of polished metal on a floor, which sees itself.
pub fn metal() -> Scene {
    let ball = spiky(vec3(0.0, 0.0, 0.4), 0.4, [1.0, 0.85]);
    small_floor()
        .constant_environment(SKY)
        .depth(6)
        .smooth("thing", ball, [0.8; 3])
        .mirror("thing")
}

/// The same, seen from near.
pub fn near_metal() -> Scene {
    let mut near = metal();
    near.sensors[0].x_fov_rad *= 0.4;
    near
}

/// The same number as with samples at rest.
#[test]
fn they_agree_with_differences() {
    let thing: [(&str, &[f32]); 2] = [
        ("thing.translation", &[1.0, 0.3, 0.2]),
        ("thing.rotation", &[0.2, 0.1, 1.0]),
    ];
    let leaves: [(&str, &[f32]); 1] = [("leaves.translation", &[0.3, 0.2, 1.0])];
    for (scene, parts, spp) in [
        (foliage(), &CAMERA[..], 1024),
        (foliage(), &leaves, 1024),
        (metal(), &thing, 1024),
        (metal(), &CAMERA, 1024),
    ] {
        let along = direction(&scene, parts);
        let runs = |method, spp, first| -> Vec<Vec<f64>> {
            let seeds = first..first + 12;
            seeds
                .map(|seed| gradient(&scene, &settings(&scene, method, spp, seed), &along))
                .collect()
        };
        println!("{parts:?}");
        let carried = |spp| runs(Method::CarriedFd, spp, 1);
        let at_rest = |spp| runs(Method::Fd, 4 * spp, 1000);
        let carried = compared(spp, RESOLUTION, [&carried, &at_rest]).agreement;
        assert!(carried.holds(SIGMAS), "{parts:?} {carried:.4?}");
    }
}

/// What moves slowly allows long steps, but colours that change meanwhile have their limits.
#[test]
fn colours_stay_within_their_limits() {
    let scene = close_up().constant_environment(SKY);
    let parts: [(&str, &[f32]); 2] = [
        ("block.translation", &[0.003, 0.0, 0.0]),
        ("floor.bsdf.reflectance.value", &[1.0; 3]),
    ];
    let along = direction(&scene, &parts);
    let runs = |method, first| -> Vec<Vec<f64>> {
        let seeds = first..first + 12;
        seeds
            .map(|seed| gradient(&scene, &settings(&scene, method, 64, seed), &along))
            .collect()
    };
    let reference = runs(Method::Reparam, 1000);
    for method in [Method::Fd, Method::CarriedFd] {
        let found = Agreement::new(&runs(method, 1), &reference);
        println!("{method:?}: {found:.4?}");
        assert!(
            found.bias.error < RESOLUTION && found.holds(SIGMAS),
            "{found:.4?}"
        );
    }
}

#[test]
fn they_are_less_noisy() {
    let near = near_metal();
    for (scene, parts, by) in [
        (&foliage(), &CAMERA[..], 5.0),
        (&near, &[("thing.translation", &[1.0, 0.3, 0.2])], 2.0),
        (&near, &CAMERA, 5.0),
    ] {
        let along = direction(scene, parts);
        let [rest, carried] = [Method::Fd, Method::CarriedFd]
            .map(|method| variance(scene, (method, 64), &along, 0..12));
        println!("{parts:?} {}", rest / carried);
        assert!(rest > by * carried, "{parts:?} {rest} {carried}");
    }
}

/// Where nothing can be carried they are differences, to the last bit.
#[test]
fn some_films_rest() {
    let mut boxes = metal();
    boxes.sensors[0].film.filter = BOX;
    let moved: [(&str, &[f32]); 1] = [("thing.translation", &[1.0, 0.3, 0.2])];
    let coloured: [(&str, &[f32]); 1] = [("floor.bsdf.reflectance.value", &[1.0, 0.5, 0.2])];
    for (scene, parts) in [(boxes, moved), (metal(), coloured)] {
        let along = direction(&scene, &parts);
        let [rest, carried] = [Method::Fd, Method::CarriedFd]
            .map(|method| gradient(&scene, &settings(&scene, method, 4, 1), &along));
        assert_eq!(rest, carried);
    }
}

#[test]
fn threads_change_nothing() {
    let scene = metal();
    let along = direction(&scene, &CAMERA);
    let [one, three] = [1, 3].map(|threads| {
        let settings = Settings {
            threads,
            ..settings(&scene, Method::CarriedFd, 8, 5)
        };
        gradient(&scene, &settings, &along)
    });
    assert_eq!(one, three);
}

/// Before the metal they are better than what is usual.
#[test]
fn auto_takes_them() {
    let scene = near_metal();
    let along = direction(&scene, &CAMERA);
    let own = settings(&scene, Method::Auto, 64, 3);
    let (settled, pilot) =
        decide(&scene, &own, &Question::Forward(&along), &Quiet).expect("a decision");
    assert_eq!(settled.method, Method::CarriedFd, "{pilot:?}");
}

/// A floor that is seen nearly from its side turns out of sight within a step, and what the steps
/// add up to is no derivative. It is said, and `auto` takes none.
#[test]
fn what_passes_within_a_step_is_told() {
    let warnings = |scene: &Scene, along: &Direction, method| {
        let settings = Settings {
            standard_error: true,
            ..settings(scene, method, 64, 1)
        };
        let done = forward(scene, &settings, along, &Quiet).expect("a gradient image");
        done.statistics.warnings
    };
    for scene in [foliage(), metal()] {
        let along = direction(&scene, &CAMERA);
        for method in [Method::Fd, Method::CarriedFd] {
            assert!(warnings(&scene, &along, method).is_empty());
        }
    }
    let height = ("height".into(), "0.02".into());
    let scene = load("scenes/failures/grazing.xml", &[height]).expect("a scene");
    let along = direction(&scene, &[("floor.rotation", &[1.0, 0.0, 0.0])]);
    for method in [Method::Fd, Method::CarriedFd] {
        let warnings = warnings(&scene, &along, method);
        println!("{warnings:?}");
        assert!(warnings.iter().any(|w| w.contains("far apart")));
    }
    let asked = settings(&scene, Method::Auto, 64, 1);
    let decided = decide(&scene, &asked, &Question::Forward(&along), &Quiet);
    let (settled, pilot) = decided.expect("a decision");
    println!("{pilot:?}");
    assert!(settled.method == Method::Auto && pilot.no_differences.is_some());
}
