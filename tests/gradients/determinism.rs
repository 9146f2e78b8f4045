//! The same seed gives the same bytes, however many threads there are and however often it runs.

use common::scenes::*;
use common::{Direction, Quiet, direction, settings};
use glam::{Vec3, Vec3A, vec3};
use warpath::methods::{
    self, Base, EditedScene, Followers, Image, Method, Objective, Parts, Settings, Workers,
};
use warpath::scene::parameters::{self, Gradient, Parameter};
use warpath::scene::{DeltaLightKind, Scene, origin};

/// More tiles than the threads are given at once, lights, an environment, several bounces.
fn room() -> Scene {
    let position = vec3(-0.5, -0.6, 1.8);
    scene(vec3(0.3, -3.4, 1.9), Vec3::ZERO, 38.0, [50, 40], GAUSSIAN)
        .depth(4)
        .constant_environment([0.2, 0.3, 0.4])
        .solid("floor", floor(2.0, 0.0), [0.6, 0.5, 0.4])
        .smooth("ball", ball(2, vec3(0.4, 0.2, 0.6), 0.4), [0.3, 0.7, 0.2])
        .solid(
            "corner",
            placed(
                l_shape(0.4, 0.5),
                vec3(8.0, 0.0, 30.0),
                vec3(-0.6, 0.0, 0.1),
            ),
            [0.7, 0.3, 0.3],
        )
        .light("lamp", ceiling(vec3(0.2, 0.1, 2.2), 0.4), [8.0, 7.0, 6.0])
        .delta_light("bulb", DeltaLightKind::Point { position }, [3.0, 2.0, 4.0])
}

fn everything_moves(scene: &Scene) -> Direction {
    direction(
        scene,
        &[
            ("ball.translation", &[1.0, 0.2, 0.3]),
            ("corner.rotation", &[0.1, 0.2, 1.0]),
            ("lamp.scale", &[1.0]),
            ("bulb.position", &[0.1, 0.3, 0.2]),
            ("cam.translation", &[0.3, 0.1, 0.2]),
            ("floor.bsdf.reflectance.value", &[1.0, 0.5, 0.2]),
        ],
    )
}

fn bits(image: &Image) -> Vec<[u32; 3]> {
    image.pixels.iter().map(|p| p.map(f32::to_bits)).collect()
}

/// All numbers of a gradient, bit by bit.
fn gradient_bits(scene: &Scene, wanted: &[Parameter], gradient: &Gradient) -> Vec<u32> {
    wanted
        .iter()
        .flat_map(|p| gradient.by(scene, p))
        .map(f32::to_bits)
        .collect()
}

/// Everything that a run gives.
#[derive(PartialEq)]
struct Outcome {
    image: Vec<[u32; 3]>,
    gradient: Vec<[u32; 3]>,
    stderr: Vec<[u32; 3]>,
    reverse: Vec<u32>,
    groups: Vec<Vec<u32>>,
    rays: Vec<(&'static str, u64)>,
}

fn run(scene: &Scene, seed: u64, threads: usize) -> Outcome {
    let settings = Settings {
        threads,
        standard_error: true,
        rr_depth: 3,
        ..settings(scene, Method::Reparam, 16, seed)
    };
    let image = methods::render(scene, &settings, &Quiet)
        .expect("an image")
        .image;
    let forward = methods::forward(scene, &settings, &everything_moves(scene), &Quiet)
        .expect("a gradient image");
    let wanted: Vec<Parameter> = parameters::list(scene)
        .into_iter()
        .filter(|p| p.differentiable)
        .collect();
    let target = Image {
        pixels: vec![[0.3, 0.2, 0.4]; 50 * 40],
        width: 50,
        height: 40,
    };
    let reverse = methods::backward(scene, &settings, &wanted, &Objective::L2(&target), &Quiet)
        .expect("a gradient");
    Outcome {
        image: bits(&image),
        gradient: bits(&forward.gradient),
        stderr: bits(&forward.stderr.expect("standard errors")),
        reverse: gradient_bits(scene, &wanted, &reverse.gradient),
        groups: reverse
            .groups
            .iter()
            .map(|g| gradient_bits(scene, &wanted, g))
            .collect(),
        rays: forward
            .statistics
            .rays
            .into_iter()
            .chain(reverse.statistics.rays)
            .collect(),
    }
}

#[test]
fn bytes_do_not_depend_on_threads_or_repetition() {
    let scene = room();
    let one = run(&scene, 5, 1);
    for threads in [1, 2, 3] {
        let other = run(&scene, 5, threads);
        assert!(
            one.image == other.image,
            "images differ with {threads} threads"
        );
        assert!(
            one.gradient == other.gradient,
            "gradient images differ with {threads} threads"
        );
        assert!(
            one.stderr == other.stderr,
            "standard errors differ with {threads} threads"
        );
        assert!(
            one.reverse == other.reverse,
            "gradients differ with {threads} threads"
        );
        assert!(
            one == other,
            "groups or ray counts differ with {threads} threads"
        );
    }
}

#[test]
fn seeds_differ() {
    let scene = room();
    let runs = [5, 6, 5 + (1 << 32)].map(|seed| run(&scene, seed, 2));
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let (a, b) = (&runs[a], &runs[b]);
        let differ = |a: &[[u32; 3]], b: &[[u32; 3]]| {
            a.iter().zip(b).filter(|(a, b)| a != b).count() * 10 > a.len() * 9
        };
        assert!(differ(&a.image, &b.image), "two seeds give the same pixels");
        assert!(
            differ(&a.gradient, &b.gradient),
            "two seeds give the same gradient image"
        );
        assert!(a.reverse != b.reverse, "two seeds give the same gradient");
    }
}

/// All that has a place, somewhere else.
fn shifted(mut scene: Scene, by: Vec3) -> Scene {
    for mesh in &mut scene.meshes {
        mesh.positions.iter_mut().for_each(|p| *p += by);
        mesh.to_world.translation += by.as_dvec3();
    }
    for sensor in &mut scene.sensors {
        sensor.to_world.translation += Vec3A::from(by);
    }
    for light in &mut scene.delta_lights {
        if let DeltaLightKind::Point { position } = &mut light.kind {
            *position += by;
        }
    }
    scene
}

#[test]
fn a_scene_far_away_gives_the_bytes_of_the_same_scene_nearby() {
    let far = shifted(room(), vec3(12345.0, -7000.0, 3000.0));
    let middle = origin(&far.meshes);
    assert!(middle.length() > 10_000.0);
    // No number of it is rounded again.
    let near = shifted(far.clone(), -middle);
    assert_eq!(origin(&near.meshes), Vec3::ZERO);
    assert!(run(&far, 5, 2) == run(&near, 5, 2));
}

/// A gradient image after the floor has been put elsewhere, as jobs edit a scene that is loaded.
/// The scene has another middle, then.
fn edited(scene: &Scene) -> Vec<[u32; 3]> {
    let settings = Settings {
        threads: 1,
        ..settings(scene, Method::Reparam, 16, 5)
    };
    let workers = Workers::new(1).expect("a thread");
    let parts = Parts::new(scene, &workers, settings.backend, &|| false).expect("parts");
    let followers = Followers::new(settings.backend);
    let mut edited = EditedScene::new(Base {
        scene,
        parts: &parts,
        followers: &followers,
    });
    let translation = parameters::find(scene, "floor.translation").expect("a parameter");
    // Multiples of what single precision tells far away.
    let set = edited.set(&translation, &[0.25, 0.125, -0.25]);
    set.expect("a value");
    edited.follow(1).expect("a structure");
    let prepared = edited.prepare(&workers, &|| false).expect("a scene");
    let direction = everything_moves(edited.scene());
    let found = prepared.forward(&settings, &direction, &Quiet);
    bits(&found.expect("a gradient image").gradient)
}

#[test]
fn edits_far_away_give_the_bytes_of_edits_nearby() {
    let far = shifted(room(), vec3(12345.0, -7000.0, 3000.0));
    let near = shifted(far.clone(), -origin(&far.meshes));
    assert!(edited(&far) == edited(&near));
    assert!(edited(&near) != run(&near, 5, 1).gradient);
}
