//! Bounces that drift with what they meet, and lobes over which directions rest, against finite
//! differences, the other sweep, and the noise of differences.

use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::{Random, Shape};
use common::statistics::Estimate;
use common::transposition::{both_sides, difference, prepared, random_weight, transposed};
use common::{differences, direction, gradient, settings, variance};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Distribution::Ggx;
use warpath::scene::{Normals, Scene};

const MOVED: (&str, &[f32]) = ("thing.translation", &[1.0, 0.3, 0.2]);
const BY_CAMERA: (&str, &[f32]) = ("cam.translation", &[0.5, 0.2, 0.3]);

/// A floor that is lit over a thing beside it, which the camera does not see: all that moves is
/// seen along bounces.
fn beside(thing: Shape) -> Scene {
    let at = vec3(0.0, 0.0, 0.0);
    scene(vec3(0.0, -3.0, 3.0), at, 9.0, [8; 2], GAUSSIAN)
        .depth(3)
        .solid("floor", floor(0.6, 0.0), [0.7, 0.6, 0.5])
        .smooth("thing", thing, [0.5; 3])
        .light("lamp", ceiling(vec3(-0.5, 0.1, 1.6), 0.4), [5.0, 6.0, 4.0])
}

fn metal_ball() -> Scene {
    beside(ball(3, vec3(0.9, 0.1, 0.5), 0.4)).metal("thing", 0.3, Ggx)
}

/// A ball whose normals turn by many times as much as a ball's.
fn dented(centre: Vec3, radius: f32) -> Shape {
    let (mut positions, triangles) = ball(3, centre, radius);
    for p in &mut positions {
        let d = (*p - centre) / radius;
        let waves = (11.0 * d.x).sin() * (13.0 * d.y).sin() + (12.0 * d.z).sin();
        *p += 0.08 * waves * radius * d;
    }
    (positions, triangles)
}

/// Small leaves in a ball, each a piece of its own, about as many of each direction.
fn leaves(centre: Vec3, radius: f32) -> Shape {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..60 {
        let [t, u, w] = [0.61803, 0.32472, 0.75488].map(|step| (step * i as f32).fract());
        let angle = std::f32::consts::TAU * u;
        let height = 2.0 * w - 1.0;
        let at = vec3(angle.cos(), angle.sin(), 0.0) * (1.0 - height * height).sqrt();
        let middle = centre + radius * t.cbrt() * (at + Vec3::Z * height);
        let side = vec3(height, at.x, at.y).normalize();
        let [a, b] = [side.any_orthonormal_vector(), side].map(|d| 0.22 * radius * d);
        let first = positions.len() as u32;
        positions.extend([
            middle - a - b,
            middle + a - b,
            middle + a + b,
            middle - a + b,
        ]);
        triangles.extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| first + v)));
    }
    (positions, triangles)
}

/// Over a lamp that shines upward, so that a floor beside it has all of its light from them.
fn crowd() -> Scene {
    let lamp = placed(floor(0.4, 0.0), Vec3::ZERO, vec3(0.9, 0.1, 0.02));
    scene(
        vec3(0.0, -3.0, 3.0),
        vec3(0.2, 0.0, 0.0),
        9.0,
        [8; 2],
        GAUSSIAN,
    )
    .depth(3)
    .solid("floor", floor(0.6, 0.0), [0.7, 0.6, 0.5])
    .solid("thing", leaves(vec3(0.9, 0.1, 0.5), 0.4), [0.5, 0.7, 0.6])
    .light("lamp", lamp, [5.0, 6.0, 4.0])
}

/// What is not round is followed by its middle and its rotation.
fn metal_bar() -> Scene {
    let bar = placed(
        cuboid(vec3(0.25, 0.45, 0.2)),
        vec3(0.0, 0.0, 15.0),
        vec3(0.7, 0.1, 0.4),
    );
    beside(bar).metal("thing", 0.6, Ggx)
}

/// It in an even sky, above a floor.
fn seen(paint: impl Fn(Scene) -> Scene) -> Scene {
    paint(above(dented(vec3(0.0, 0.0, 0.45), 0.35)))
}

fn above(thing: Shape) -> Scene {
    let from = vec3(0.3, -3.0, 1.6);
    scene(from, vec3(0.0, 0.0, 0.35), 20.0, [10; 2], GAUSSIAN)
        .depth(4)
        .solid("floor", floor(0.7, 0.0), [0.7, 0.3, 0.2])
        .smooth("thing", thing, [0.6; 3])
        .constant_environment(SKY)
}

/// A painted ball beside a floor has about as much noise of facets as it has if they are smoothed
/// over; it would have 24 times as much.
#[test]
fn facets_of_a_ball_are_followed() {
    let thing = ball(3, vec3(0.9, 0.1, 0.5), 0.4);
    let smooth = beside(thing.clone());
    let mut flat = beside(thing);
    let mesh = flat.meshes.iter_mut().find(|m| m.id == "thing");
    mesh.expect("a mesh").normals = Normals::Flat;
    let [smooth, flat] = [smooth, flat].map(|scene| {
        let along = direction(&scene, &[MOVED]);
        variance(&scene, (Method::Reparam, 64), &along, 0..24)
    });
    println!("{flat} {smooth}");
    assert!(flat < 5.0 * smooth, "{flat} {smooth}");
}

/// Directions drift with a ball that nobody sees, before an even sky, over surfaces that send the
/// more or the less of light for where it comes from: nothing changes.
#[test]
fn what_uneven_surfaces_send_along_the_drift() {
    let paints: [fn(Scene) -> Scene; 3] = [
        |scene| scene.plastic("floor", Some(0.3)),
        |scene| scene.relief("floor", Some(1.0)),
        |scene| scene.layers("floor", 0.3),
    ];
    for paint in thinned(3, paints) {
        let from = vec3(0.0, -3.0, 3.0);
        let scene = scene(from, Vec3::ZERO, 9.0, [8; 2], GAUSSIAN)
            .depth(4)
            .solid("floor", floor(0.6, 0.0), [0.8; 3])
            .smooth("thing", ball(3, vec3(0.9, 0.1, 0.5), 0.4), [0.5; 3])
            .null("thing")
            .constant_environment([1.0; 3]);
        let scene = paint(scene);
        let along = direction(&scene, &[MOVED]);
        let found = with_samples(1024, 5e-4, |spp| {
            let mean = |seed| {
                let settings = settings(&scene, Method::Reparam, spp, seed);
                let all = gradient(&scene, &settings, &along);
                all.iter().sum::<f64>() / all.len() as f64
            };
            let runs: Vec<f64> = (0..32).map(mean).collect();
            let found = Estimate::mean(&runs);
            println!("{spp} samples: {found:?}");
            (found.error, found)
        });
        assert!(found.z(0.0).abs() < 4.0, "{found:?}");
    }
}

/// Over which diffuse directions rest, and others do not.
fn painted_ball() -> Scene {
    above(ball(3, vec3(0.0, 0.0, 0.45), 0.35))
}

fn of_glass() -> Scene {
    seen(|scene| scene.glass("thing", 0.3)).depth(5)
}

/// Holds `reparam` with up to `spp` samples to differences with four times as many, of a short
/// step: what is full of detail does not change in proportion to a long one.
fn agrees(scene: &Scene, part: (&str, &[f32]), spp: u32) {
    let along = direction(scene, &[part]);
    let ours = |spp| {
        let run = |seed| gradient(scene, &settings(scene, Method::Reparam, spp, seed), &along);
        (0..16).map(run).collect()
    };
    let theirs = |spp| {
        let run = |seed| {
            let settings = settings(scene, Method::Fd, 4 * spp, seed);
            differences(scene, &settings, &along, 2e-3)
        };
        (1000..1016).map(run).collect()
    };
    println!("{}", part.0);
    let found = compared(spp, 0.06, [&ours, &theirs]).agreement;
    assert!(found.holds(4.0), "reparam is off: {found:.4?}");
}

#[test]
fn a_ball_of_metal_that_a_floor_sees() {
    for part in thinned(2, [MOVED, BY_CAMERA]) {
        agrees(&metal_ball(), part, 512);
    }
}

#[test]
fn a_dented_thing_of_metal() {
    let scene = seen(|scene| scene.metal("thing", 0.3, Ggx));
    for part in [MOVED, BY_CAMERA] {
        agrees(&scene, part, 512);
    }
}

#[test]
fn a_dented_thing_of_glass() {
    for part in thinned(2, [MOVED, BY_CAMERA]) {
        agrees(&of_glass(), part, 256);
    }
}

#[test]
fn a_dented_thing_of_paint() {
    agrees(&seen(|scene| scene), MOVED, 256);
}

#[test]
fn a_dented_thing_of_plastic() {
    let scene = seen(|scene| scene.plastic("thing", Some(0.3)));
    for part in thinned(2, [MOVED, BY_CAMERA]) {
        agrees(&scene, part, 512);
    }
    agrees(&seen(|scene| scene.plastic("thing", None)), MOVED, 512);
}

/// What is black over lobes that rest has the gradient by its colour that it has where nothing
/// moves.
#[test]
fn black_lobes() {
    const COLOUR: &str = "thing.bsdf.specular_reflectance";
    let colour = format!("{COLOUR}.value");
    let still: (&str, &[f32]) = (&colour, &[1.0]);
    let paints: [fn(Scene) -> Scene; 3] = [
        |scene| scene.metal("thing", 0.3, Ggx),
        |scene| scene.plastic("thing", Some(0.3)),
        |scene| scene.glass("thing", 0.3),
    ];
    for paint in paints {
        let mut scene = seen(paint);
        for texture in scene.textures.iter_mut().filter(|t| t.key == COLOUR) {
            texture.texels = vec![[0.0; 3]];
        }
        let mean = |parts: &[(&str, &[f32])], seed| {
            let settings = settings(&scene, Method::Reparam, 64, seed);
            let all = gradient(&scene, &settings, &direction(&scene, parts));
            all.iter().sum::<f64>() / all.len() as f64
        };
        let moved: (&str, &[f32]) = (MOVED.0, &[1e-6; 3]);
        let pairs = (0..12).map(|seed| [mean(&[still], seed), mean(&[still, moved], seed)]);
        let pairs: Vec<[f64; 2]> = pairs.collect();
        // Facets that are seen edge-on have samples of their own if they move.
        let off = Estimate::mean(&pairs.iter().map(|[a, b]| a - b).collect::<Vec<_>>());
        let least = pairs.iter().map(|[a, _]| *a).fold(f64::MAX, f64::min);
        println!("{off:?} of {least}");
        assert!(off.error < 0.02 * least, "{pairs:?}");
        assert!(off.z(0.0).abs() < 4.0, "{off:?} of {least}");
        let weight = random_weight(&mut Random::new(5), &scene);
        let along = direction(&scene, &[still, moved]);
        let sides = both_sides(&prepared(&scene), &along, &weight, Method::Reparam);
        assert_eq!(difference("black", &sides), None);
    }
}

/// Wide lobes share a lamp with light samples.
#[test]
fn dented_things_under_a_lamp() {
    let paints: [fn(Scene) -> Scene; 3] = [
        |scene| scene.metal("thing", 0.3, Ggx),
        |scene| scene.plastic("thing", Some(0.3)).relief("thing", None),
        |scene| scene.layers("thing", 0.3),
    ];
    for paint in thinned(3, paints) {
        let lamp = ceiling(vec3(-0.3, -0.5, 1.3), 0.4);
        let scene = seen(paint).light("lamp", lamp, [5.0, 6.0, 4.0]);
        agrees(&scene, MOVED, 512);
    }
}

#[test]
fn a_dented_thing_of_layers() {
    let scene = seen(|scene| scene.layers("thing", 0.3));
    for part in [MOVED, BY_CAMERA] {
        agrees(&scene, part, 512);
    }
    let clear = seen(|scene| scene.clear_layers("thing", 0.3));
    agrees(&clear, BY_CAMERA, 512);
}

#[test]
fn a_dented_thing_of_brushed_metal() {
    let scene = seen(|scene| scene.brushed("thing", [0.2, 0.4], Ggx));
    agrees(&scene, MOVED, 512);
}

#[test]
fn a_dented_thing_with_a_relief() {
    let paints: [fn(Scene) -> Scene; 5] = [
        |scene| scene,
        |scene| scene.metal("thing", 0.3, Ggx),
        |scene| scene.plastic("thing", Some(0.3)),
        |scene| scene.glass("thing", 0.3),
        |scene| scene.layers("thing", 0.3),
    ];
    let parts = [MOVED, MOVED, BY_CAMERA, BY_CAMERA, MOVED];
    for bumps in thinned(2, [None, Some(0.05)]) {
        for (paint, part) in thinned(2, paints.into_iter().zip(parts)) {
            agrees(&seen(|s| paint(s).relief("thing", bumps)), part, 512);
        }
    }
}

#[test]
fn a_ball_of_paint() {
    for part in [MOVED, BY_CAMERA] {
        agrees(&painted_ball(), part, 256);
    }
}

#[test]
fn a_crowd_that_a_floor_sees() {
    let turned: (&str, &[f32]) = ("thing.rotation", &[0.5, 0.8, 0.3]);
    for part in thinned(2, [turned, MOVED]) {
        agrees(&crowd(), part, 512);
    }
}

#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn a_bar_of_metal_that_a_floor_sees() {
    agrees(&metal_bar(), ("thing.rotation", &[0.2, 1.0, 0.1]), 1024);
}

#[test]
fn transposition() {
    let painted = "thing.bsdf.brdf_0.reflectance.value";
    let black = "lamp.bsdf.brdf_0.reflectance.value";
    transposed(&metal_ball(), Method::Reparam, &[painted, black]);
    transposed(&of_glass(), Method::Reparam, &[painted]);
    transposed(&metal_bar(), Method::Reparam, &[painted, black]);
    transposed(&crowd(), Method::Reparam, &[black]);
    let metal = seen(|scene| scene.metal("thing", 0.1, Ggx));
    transposed(&metal, Method::Reparam, &[painted]);
    transposed(&seen(|scene| scene), Method::Reparam, &[]);
    let plastic = seen(|scene| scene.plastic("thing", Some(0.2)));
    transposed(&plastic, Method::Reparam, &[painted]);
    let brushed = seen(|scene| scene.brushed("thing", [0.2, 0.4], Ggx));
    let layers = seen(|scene| scene.layers("thing", 0.2));
    transposed(&layers, Method::Reparam, &[painted]);
    let clear = seen(|scene| scene.clear_layers("thing", 0.2));
    transposed(&clear, Method::Reparam, &[painted]);
    let alpha = "thing.bsdf.alpha.value";
    transposed(&brushed, Method::Reparam, &[painted, alpha]);
    transposed(&painted_ball(), Method::Reparam, &[]);
}

#[test]
fn transposition_of_reliefs() {
    let painted = "thing.bsdf.brdf_0.reflectance.value";
    for bumps in thinned(2, [None, Some(0.05)]) {
        let turned = |paint: fn(Scene) -> Scene| seen(|s| paint(s).relief("thing", bumps));
        transposed(&turned(|scene| scene), Method::Reparam, &[]);
        let metal = turned(|scene| scene.metal("thing", 0.2, Ggx));
        let plastic = turned(|scene| scene.plastic("thing", Some(0.2)));
        let glass = turned(|scene| scene.glass("thing", 0.2));
        let layers = turned(|scene| scene.layers("thing", 0.2));
        for scene in [metal, plastic, glass, layers] {
            transposed(&scene, Method::Reparam, &[painted]);
        }
    }
}

/// Inside of glass a direction that turned with the normals would turn by many times as much at
/// every reflection.
#[test]
fn its_noise_is_that_of_differences() {
    let scene = of_glass();
    let along = direction(&scene, &[MOVED]);
    let [ours, differences] =
        [Method::Reparam, Method::Fd].map(|method| variance(&scene, (method, 64), &along, 0..12));
    println!("{ours} {differences}");
    assert!(ours < differences, "{ours} {differences}");
}
