//! A run traces and computes only what the requested parameters need.

use common::materials::Paint;
use common::scenes::*;
use common::shapes::{Random, soup};
use common::transposition::rounding;
use common::{Quiet, direction, flat, gradient, settings};
use glam::{Vec3, vec3};
use std::collections::BTreeMap;
use warpath::methods::{Image, Method, Objective, Statistics, backward, forward, render};
use warpath::scene::Distribution::Ggx;
use warpath::scene::parameters;
use warpath::scene::{DeltaLightKind, Scene};
use warpath::statistics::agreement::Agreement;

type Rays = BTreeMap<&'static str, u64>;

const SPP: u32 = 16;

/// Rays that only look for silhouettes.
const SEARCHING: [&str; 5] = ["light_cell", "bounce_cell", "sky_cell", "edge", "probe"];

/// A block over a floor, and one behind the camera that nothing sees and that throws no shadow
/// anywhere.
fn room(depth: u32) -> Scene {
    let block = |to| placed(cuboid(vec3(0.35, 0.2, 0.12)), vec3(12.0, 25.0, 33.0), to);
    let wall = parallelogram(
        vec3(-3.0, -4.0, -1.0),
        vec3(0.0, 0.0, 6.0),
        vec3(6.0, 0.0, 0.0),
    );
    scene(
        vec3(0.3, -3.4, 1.9),
        vec3(0.0, 0.0, 0.1),
        38.0,
        [16; 2],
        BOX,
    )
    .depth(depth)
    .solid("floor", floor(1.5, 0.0), [0.6, 0.5, 0.4])
    .solid("block", block(vec3(0.1, 0.0, 0.75)), [0.3, 0.6, 0.5])
    .solid("wall", wall, [0.0; 3])
    .solid("unseen", block(vec3(0.0, -8.0, 0.0)), [0.4; 3])
    .light("lamp", ceiling(vec3(0.2, 0.1, 2.2), 0.45), [8.0, 7.0, 6.0])
}

fn rays_of(statistics: &Statistics) -> Rays {
    statistics.rays.clone()
}

fn forward_rays(scene: &Scene, parts: &[(&str, &[f32])], method: Method) -> (Vec<f64>, Rays) {
    let along = direction(scene, parts);
    let result =
        forward(scene, &settings(scene, method, SPP, 1), &along, &Quiet).expect("a gradient image");
    (flat(&result.gradient), rays_of(&result.statistics))
}

fn backward_rays(scene: &Scene, key: &str) -> (Vec<f32>, Rays) {
    let wanted = [parameters::find(scene, key).expect("a key")];
    let weight = Image {
        width: 16,
        height: 16,
        pixels: vec![[1.0, 0.5, 0.3]; 256],
    };
    let settings = settings(scene, Method::Reparam, SPP, 1);
    let result = backward(
        scene,
        &settings,
        &wanted,
        &Objective::Adjoint(&weight),
        &Quiet,
    )
    .expect("a gradient");
    (
        result.gradient.by(scene, &wanted[0]),
        rays_of(&result.statistics),
    )
}

fn count(rays: &Rays, kind: &str) -> u64 {
    rays.get(kind).copied().unwrap_or(0)
}

fn assert_searches_nothing(what: &str, rays: &Rays) {
    for kind in SEARCHING {
        assert_eq!(count(rays, kind), 0, "{what} traces {kind} rays: {rays:?}");
    }
}

/// Colours need the paths of the image and no more.
#[test]
fn colours_search_no_silhouettes() {
    for scene in [room(2), room(4), room(3).constant_environment([0.2; 3])] {
        let image =
            render(&scene, &settings(&scene, Method::Reparam, SPP, 1), &Quiet).expect("an image");
        let image = rays_of(&image.statistics);
        for key in [
            "floor.bsdf.reflectance.value",
            "lamp.emitter.radiance.value",
        ] {
            let (gradient, rays) =
                forward_rays(&scene, &[(key, &[1.0, 0.5, 0.2])], Method::Reparam);
            assert!(gradient.iter().any(|g| *g != 0.0), "{key} has no gradient");
            assert_searches_nothing(key, &rays);
            assert_eq!(rays, image, "{key}: other rays than the image's");
            let (gradient, rays) = backward_rays(&scene, key);
            assert!(gradient.iter().all(|g| *g != 0.0), "{key} has no gradient");
            assert_searches_nothing(key, &rays);
            assert_eq!(rays, image, "{key}: other rays than the image's");
        }
    }
}

#[test]
fn interior_searches_no_silhouettes() {
    let (_, rays) = forward_rays(
        &room(3),
        &[("block.translation", &[1.0, 0.0, 0.0])],
        Method::Interior,
    );
    assert_searches_nothing("interior", &rays);
}

/// A gradient by what nothing sees is zero, exactly.
#[test]
fn what_is_not_seen_has_no_gradient() {
    for scene in [room(2), room(4)] {
        for (key, values) in [
            ("unseen.translation", [1.0, 0.5, 0.2].as_slice()),
            ("unseen.vertex_positions", &[1.0, 0.5, 0.2]),
            ("unseen.rotation", &[1.0, 0.5, 0.2]),
            ("unseen.scale", &[1.0]),
            ("unseen.bsdf.reflectance.value", &[1.0, 0.5, 0.2]),
        ] {
            let (gradient, _) = forward_rays(&scene, &[(key, values)], Method::Reparam);
            assert!(gradient.iter().all(|g| *g == 0.0), "{key} has a gradient");
            let (gradient, _) = backward_rays(&scene, key);
            assert!(gradient.iter().all(|g| *g == 0.0), "{key} has a gradient");
        }
    }
}

/// A direction of zeros moves nothing.
#[test]
fn nothing_that_moves_has_no_gradient() {
    let scene = room(3).constant_environment([0.3; 3]);
    let still: [(&str, &[f32]); 4] = [
        ("block.translation", &[0.0; 3]),
        ("cam.rotation", &[0.0; 3]),
        ("lamp.scale", &[0.0]),
        ("floor.bsdf.reflectance.value", &[0.0; 3]),
    ];
    for method in [Method::Reparam, Method::Interior] {
        let (gradient, _) = forward_rays(&scene, &still, method);
        assert!(gradient.iter().all(|g| *g == 0.0), "{}", method.name());
    }
    let (gradient, rays) = forward_rays(&scene, &[], Method::Reparam);
    assert!(gradient.iter().all(|g| *g == 0.0));
    assert_searches_nothing("no parameter at all", &rays);
}

/// An adjoint image of zeros pulls back to zero.
#[test]
fn no_adjoint_no_gradient() {
    let scene = room(3);
    let differentiable = |p: &parameters::Parameter| p.differentiable;
    let wanted: Vec<_> = parameters::list(&scene)
        .into_iter()
        .filter(differentiable)
        .collect();
    let weight = Image {
        width: 16,
        height: 16,
        pixels: vec![[0.0; 3]; 256],
    };
    let settings = settings(&scene, Method::Reparam, SPP, 1);
    let result = backward(
        &scene,
        &settings,
        &wanted,
        &Objective::Adjoint(&weight),
        &Quiet,
    )
    .expect("a gradient");
    for parameter in &wanted {
        let gradient = result.gradient.by(&scene, parameter);
        assert!(gradient.iter().all(|g| *g == 0.0), "{}", parameter.key);
    }
}

/// Each kind of ray is traced where it has something to find.
#[test]
fn rays_are_those_that_the_scene_asks_for() {
    let moving = [("block.translation", [1.0, 0.2, 0.1].as_slice())];
    let pixels = 16 * 16 * u64::from(SPP);

    let image = render(
        &room(2),
        &settings(&room(2), Method::Reparam, SPP, 1),
        &Quiet,
    )
    .expect("an image");
    let image = rays_of(&image.statistics);
    assert_eq!(count(&image, "camera"), pixels);
    assert!(count(&image, "shadow") > 0 && count(&image, "shadow") <= pixels);
    assert_eq!(
        count(&image, "bounce"),
        0,
        "direct light from lamps needs no bounce"
    );
    assert_searches_nothing("an image", &image);

    // Silhouettes on the film and before the lamp; around each tile one more row and column.
    let (_, direct) = forward_rays(&room(2), &moving, Method::Reparam);
    assert!(count(&direct, "camera") >= pixels && count(&direct, "camera") < 2 * pixels);
    assert!(count(&direct, "light_cell") > 0);
    assert_eq!(
        count(&direct, "bounce_cell"),
        0,
        "nothing arrives by bounces at depth 2 without a sky"
    );
    assert_eq!(count(&direct, "bounce"), 0);

    let (_, indirect) = forward_rays(&room(3), &moving, Method::Reparam);
    assert!(
        count(&indirect, "bounce_cell") > 0,
        "indirect light has silhouettes over the hemisphere"
    );

    // Under the sky alone there is no light to sample.
    let mut sky = room(2).constant_environment([1.0; 3]);
    sky.meshes.pop();
    sky.area_lights.clear();
    let (_, sky) = forward_rays(&sky, &moving, Method::Reparam);
    assert_eq!(count(&sky, "shadow") + count(&sky, "light_cell"), 0);
    assert!(count(&sky, "bounce") > 0 && count(&sky, "bounce_cell") > 0);

    // Only what the camera sees emits: no light falls on anything at depth 1.
    let (_, seen) = forward_rays(&room(1), &moving, Method::Reparam);
    let kinds: Vec<_> = seen.keys().copied().filter(|k| *k != "probe").collect();
    assert_eq!(kinds, ["camera"], "rays at depth 1: {seen:?}");
}

/// Silhouettes are looked for where one that moves may be found: that changes the rays that are
/// traced, and no gradient. Here everything counts as moving that a camera at rest sees.
#[test]
fn what_rests_is_left_out_and_nothing_else() {
    let small = |scene: Scene| {
        let leaf = placed(
            cuboid(vec3(0.02, 0.15, 0.1)),
            vec3(10.0, 20.0, 50.0),
            vec3(-0.5, 0.2, 0.3),
        );
        scene.solid("leaf", leaf, [0.5, 0.2, 0.1])
    };
    let sky = |scene: Scene| scene.constant_environment([0.2, 0.3, 0.4]);
    let scenes = [
        ("lamp", small(room(2))),
        ("indirect", small(room(4))),
        ("sky", sky(small(room(3)))),
        ("sky alone", {
            let mut scene = sky(small(room(2)));
            scene.meshes.retain(|m| m.id != "lamp");
            scene.area_lights.clear();
            scene
        }),
        ("bulb", {
            let mut scene = small(room(2));
            scene.meshes.retain(|m| m.id != "lamp");
            scene.area_lights.clear();
            let position = vec3(0.2, 0.1, 2.2);
            scene.delta_light("bulb", DeltaLightKind::Point { position }, [8.0; 3])
        }),
        ("metal", sky(small(room(3))).metal("floor", 0.05, Ggx)),
        ("map", small(room(3)).sunny()),
        // Thinner than the film's cells, whose ends both see the grass, which rests.
        ("grass", {
            let wire = parallelogram(
                vec3(-0.5, 0.0, 0.9),
                vec3(1.0, 0.1, 0.0),
                vec3(0.0, 0.0, 0.003),
            );
            let (positions, triangles) = soup(&mut Random::new(3), 200, 0.3);
            let grass = (positions.into_iter().map(|p| p * 0.8).collect(), triangles);
            room(1)
                .solid("leaf", wire, [0.0; 3])
                .light("grass", grass, [1.0, 0.5, 0.2])
        }),
    ];
    for (what, scene) in scenes {
        for moving in ["leaf", "block", "lamp", "floor"] {
            if scene.meshes.iter().all(|m| m.id != moving) {
                continue;
            }
            let key = format!("{moving}.translation");
            let own = (key.as_str(), [1.0, 0.3, 0.2].as_slice());
            let (alone, few) = forward_rays(&scene, &[own], Method::Reparam);
            let camera: (&str, &[f32]) = ("cam.translation", &[0.0; 3]);
            let (all, many) = forward_rays(&scene, &[own, camera], Method::Reparam);
            let largest = all.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            let allowed = rounding(scene.integrator.max_depth) * largest;
            let mut pairs = alone.iter().zip(&all);
            if !pairs.all(|(a, b)| (a - b).abs() <= allowed) {
                agree(&scene, [&[own], &[own, camera]]);
            }
            let searching = |rays: &Rays| SEARCHING.map(|kind| count(rays, kind)).iter().sum();
            let [few, many]: [u64; 2] = [searching(&few), searching(&many)];
            assert!(few <= many, "{what}, {moving}: {few} rays of {many}");
            if moving == "leaf" {
                assert!(few < many / 2, "{what}: {few} rays of {many}");
            }
        }
    }
}

/// Silhouettes that move share a tile's looks, so that each has fewer where more of them do. Then
/// the gradients are the same in the mean, and nearly so by the same seeds.
fn agree(scene: &Scene, parts: [&[(&str, &[f32])]; 2]) {
    let [alone, all] = parts.map(|parts| {
        let along = direction(scene, parts);
        let run = |seed| gradient(scene, &settings(scene, Method::Reparam, SPP, seed), &along);
        (0..24).map(run).collect::<Vec<_>>()
    });
    let found = Agreement::new(&alone, &all);
    println!("{:?}: {found:.4?}", parts[0]);
    assert!(found.bias.error <= 0.05, "nothing can be said: {found:.4?}");
    assert!(found.holds(4.0), "{:?}: {found:.4?}", parts[0]);
}

/// The reverse sweep traces no ray: both modes trace the same.
#[test]
fn both_modes_trace_the_same_rays() {
    for depth in [2, 4] {
        let scene = room(depth);
        let (_, forward) = forward_rays(
            &scene,
            &[("block.translation", &[1.0, 0.2, 0.1])],
            Method::Reparam,
        );
        let (_, backward) = backward_rays(&scene, "block.translation");
        assert_eq!(forward, backward);
    }
}

/// Every bounce between mirrors of many facets cuts lines into more parts. What a bounce costs in
/// looking for edges does not grow with the number of parts.
#[test]
fn mirrors_that_face_each_other_are_followed_on_few_parts() {
    let plate = parallelogram(vec3(0.3, 0.1, 0.2), Vec3::X * 0.3, Vec3::Z * 0.3);
    let hall = scene(vec3(0.3, -0.6, 0.2), Vec3::ZERO, 50.0, [8; 2], GAUSSIAN)
        .smooth("hall", ball(4, Vec3::ZERO, 1.0), [0.5; 3])
        .smooth("ball", ball(4, vec3(0.0, 0.2, 0.0), 0.2), [0.5; 3])
        .solid("plate", plate, [0.5; 3])
        .light("lamp", ball(1, vec3(-0.5, 0.0, 0.4), 0.05), [20.0; 3])
        .mirror("hall")
        .mirror("ball");
    let probes_per_bounce = |depth| {
        let parts: [(&str, &[f32]); 1] = [("plate.translation", &[1.0, 0.0, 0.0])];
        let (_, rays) = forward_rays(&hall.clone().depth(depth), &parts, Method::Reparam);
        count(&rays, "probe") as f64 / count(&rays, "bounce") as f64
    };
    let [few, many] = [probes_per_bounce(6), probes_per_bounce(24)];
    println!("{few:.1} and {many:.1} rays a bounce");
    assert!(few > 1.0, "mirrors are looked into");
    assert!(
        many < 4.0 * few,
        "{many:.1} rays a bounce look for edges, {few:.1} do at a fourth of the depth"
    );
}
