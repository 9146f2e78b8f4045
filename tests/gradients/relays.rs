//! Vertices that move fast, which paths are compared at over a step (`paths::relay`).

use common::compared::agreement;
use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::*;
use common::scenes::*;
use common::shapes::Shape;
use common::transposition::transposed;
use common::{Quiet, differences, direction, gradient, settings, variance};
use glam::{Vec3, vec3};
use std::f32::consts::PI;
use std::ops::Range;
use warpath::methods::{Method, forward};
use warpath::scene::{DeltaLightKind, Distribution, Scene};

const MOVED: [f32; 3] = [1.0, 0.2, 0.4];

/// Small balls of glass and metal above a floor that shines a little, before a wall.
fn small_balls() -> Scene {
    room(5)
        .smooth("glass", ball(3, vec3(-0.45, -0.5, 0.3), 0.1), [0.5; 3])
        .smooth("metal", ball(3, vec3(0.4, -0.6, 0.35), 0.07), [0.5; 3])
        .clear("glass")
        .metal("metal", 0.05, Distribution::Ggx)
        .plastic("floor", Some(0.05))
}

/// Rays that are traced because vertices move fast.
fn relayed(scene: &Scene, (key, by): (&str, &[f32])) -> u64 {
    let along = direction(scene, &[(key, by)]);
    let settings = settings(scene, Method::Reparam, 64, 1);
    let done = forward(scene, &settings, &along, &Quiet).expect("a gradient image");
    done.statistics.rays.get("relay").copied().unwrap_or(0)
}

fn check_relayed(scene: &Scene, (key, by): (&str, &[f32])) {
    assert!(relayed(scene, (key, by)) > 100, "{key}");
    println!("{key}");
    check_to(0.02, scene, &[(key, by)], 1024, Some(0.003), Fails);
}

#[test]
fn what_small_balls_show_is_right() {
    let scene = small_balls();
    for key in thinned(2, ["cam.translation", "block.translation"]) {
        check_relayed(&scene, (key, &MOVED));
    }
}

/// A floor up to a black wall, in a ball of metal.
fn up_to_a_wall() -> Scene {
    let eye = vec3(0.3, -3.4, 1.9);
    let corner = vec3(-3.0, -1.6, 0.0);
    let wall = parallelogram(corner, vec3(0.0, 0.0, 1.0), vec3(6.0, 0.0, 0.0));
    lit(scene(eye, vec3(0.0, 0.1, 0.37), 3.0, [4; 2], GAUSSIAN))
        .solid("floor", floor(2.2, 0.0), [0.6, 0.5, 0.4])
        .solid("wall", wall, [0.0; 3])
        .smooth("ball", ball(4, vec3(0.0, 0.1, 0.4), 0.15), [0.5; 3])
        .mirror("ball")
        .depth(3)
}

/// No step ends within the wall, where the plane of the floor is dark.
#[test]
fn floors_end_at_walls() {
    let scene = up_to_a_wall();
    let moved: (&str, &[f32]) = ("ball.translation", &MOVED);
    assert!(relayed(&scene, moved) > 100);
    let along = direction(&scene, &[moved]);
    let settings = |method, spp, seed| settings(&scene, method, spp, seed);
    // The row that shows the corner: what the others show of the lamp and the rim would drown it.
    let row = |image: Vec<f64>| image[image.len() / 2..image.len() * 3 / 4].to_vec();
    let ours = |seed| gradient(&scene, &settings(Method::Reparam, 1024, seed), &along);
    let theirs = |seed| differences(&scene, &settings(Method::Fd, 4096, seed), &along, 0.006);
    let ours: Vec<_> = (1..13).map(ours).map(row).collect();
    let theirs: Vec<_> = (1000..1012).map(theirs).map(row).collect();
    let found = agreement(&ours, &theirs);
    assert!(found.holds(SIGMAS), "{found:.4?}");
    println!("{found:.4?}");
}

/// A ball of rough glass that throws its caustic around where it stands.
pub fn caustic() -> Scene {
    lit(small_floor())
        .smooth("ball", ball(3, vec3(0.1, 0.0, 0.3), 0.28), [0.5; 3])
        .glass("ball", 0.1)
        .depth(5)
}

/// Bounces from the floor follow the ball: they turn, and where they meet it does not slide. By
/// −0.25 ± 0.03 wrong if relays take them not to turn.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes minutes: make test-long")]
fn what_turns_toward_a_relay_is_right() {
    let moved: (&str, &[f32]) = ("ball.translation", &MOVED);
    let scene = caustic();
    assert!(relayed(&scene, moved) > 100);
    check_to(0.05, &scene, &[moved], 1024, Some(0.003), Fails);
}

/// The index of refraction moves all that is seen.
const BY_ETA: (&str, &[f32]) = ("ball.bsdf.eta", &[1.0]);

/// A border before a relay, and no part of its differences.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes minutes: make test-long")]
fn a_sharp_shadow_over_relays_is_found_once() {
    let position = vec3(-0.6, -0.9, 2.6);
    let light = DeltaLightKind::Point { position };
    let scene = behind_a_ball()
        .clear("ball")
        .delta_light("bulb", light, [8.0, 7.0, 6.0]);
    check_relayed(&scene, BY_ETA);
}

/// Likewise.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes minutes: make test-long")]
fn a_picture_that_jumps_over_relays_is_found_once() {
    let scene = lit(behind_a_ball().clear("ball")).checkerboard("floor");
    check_to(0.02, &scene, &[BY_ETA], 1024, Some(0.003), Fails);
}

/// Where nothing moves that a path has met nothing is compared.
#[test]
fn what_rests_has_none() {
    assert_eq!(relayed(&small_balls(), ("lamp.translation", &MOVED)), 0);
}

/// Small mirror balls above a floor of rough metal that shows them, and they a map with a sun.
fn balls_in_the_sun() -> Scene {
    let ball_at = |scene: Scene, number: u8| {
        let id = format!("ball{number}");
        let [x, y] = [number % 3, number / 3].map(|step| 0.4 * f32::from(step) - 0.4);
        let scene = scene.smooth(&id, ball(2, vec3(x, y, 0.25), 0.06), [0.5; 3]);
        scene.mirror(&id)
    };
    let floor = small_floor().metal("floor", 0.1, Distribution::Ggx);
    (0..9).fold(floor, ball_at).sunny().depth(3)
}

/// Where paths leave the scene the map is compared, without a ray.
#[test]
fn a_map_in_a_ball_of_few_pixels_is_right() {
    let eye = vec3(0.3, -3.4, 1.9);
    let scene = scene(eye, vec3(0.0, 0.0, 0.2), 26.0, [16; 2], GAUSSIAN)
        .smooth("metal", ball(4, vec3(0.0, 0.0, 0.2), 0.28), [0.5; 3])
        .mirror("metal")
        .sunny()
        .depth(2);
    let parts = [("cam.translation", MOVED.as_slice())];
    check_to(0.02, &scene, &parts, 1024, Some(0.003), Fails);
}

/// Smooth balls of glass and metal that show each other.
fn cluster() -> Scene {
    let ball_at = |scene: Scene, number: u8| {
        let id = format!("ball{number}");
        let [x, y, z] = [0.37, 0.71, 0.53].map(|step| (f32::from(number) * step).fract() - 0.5);
        let at = vec3(0.05, -0.65, 0.35) + vec3(0.7 * x, 0.5 * y, 0.4 * z);
        let scene = scene.smooth(&id, ball(2, at, 0.1), [0.5; 3]);
        match number % 2 {
            0 => scene.clear(&id),
            _ => scene.mirror(&id),
        }
    };
    (0..16).fold(room(12), ball_at)
}

/// Variances as parts of those of differences.
fn check_quieter(
    most: f64,
    scene: &Scene,
    (moved, spp): ((&str, &[f32]), u32),
    seeds: [Range<u64>; 2],
) {
    let along = direction(scene, &[moved]);
    for seeds in seeds {
        let of = |method| variance(scene, (method, spp), &along, seeds.clone());
        let ratio = of(Method::Reparam) / of(Method::Fd);
        println!("{ratio}");
        assert!(ratio < most, "{ratio}");
    }
}

fn check_quiet(scene: &Scene, spp: u32) {
    let moved: (&str, &[f32]) = ("cam.translation", &MOVED);
    check_quieter(0.1, scene, (moved, spp), [1..7, 200..206]);
}

/// Without relays single paths have most of the variance: with these random numbers 3 times that of
/// differences, and 0.16 times.
#[test]
fn long_chains_are_quiet() {
    check_quiet(&cluster(), 64);
}

/// Likewise, where the last rays of paths leave the scene: 5.5 times that of differences if those
/// are no relays.
#[test]
fn a_sun_in_small_balls_is_quiet() {
    check_quiet(&balls_in_the_sun(), 256);
}

/// Leaves that cut through each other in the line of sight, a few hundredths of a pixel thick as
/// the camera sees them. The film follows what is behind them, and they slide under it.
fn leaves_seen_edge_on() -> Scene {
    let mut leaves: Shape = (Vec::new(), Vec::new());
    for number in 0..8 {
        let angle_rad = 0.2 + number as f32 * PI / 8.0;
        let [u, v] = [vec3(angle_rad.cos(), 0.0, angle_rad.sin()), Vec3::Y].map(|side| side * 0.6);
        let (corners, triangles) = parallelogram(vec3(0.0, 0.0, 0.5) - (u + v) / 2.0, u, v);
        let first = leaves.0.len() as u32;
        leaves.0.extend(corners);
        leaves
            .1
            .extend(triangles.iter().map(|ids| ids.map(|i| first + i)));
    }
    scene(
        vec3(0.012, -3.4, 0.51),
        vec3(0.0, 0.0, 0.5),
        20.0,
        [12; 2],
        GAUSSIAN,
    )
    .constant_environment([0.8, 1.0, 1.2])
    .solid("leaves", leaves, [0.6, 0.5, 0.3])
    .depth(3)
}

/// What such leaves see of each other jumps, and is multiplied with how fast they slide if they are
/// no relays: 55 and 6 times the variance of differences.
#[test]
fn leaves_seen_edge_on_are_quiet() {
    let scene = leaves_seen_edge_on();
    let moved: (&str, &[f32]) = ("leaves.translation", &[0.2, 0.1, 1.0]);
    check_quieter(3.0, &scene, (moved, 64), [1..9, 200..208]);
    check_to(0.05, &scene, &[moved], 256, None, Fails);
}

#[test]
fn transposition() {
    let idle = |ids: &[&str]| -> Vec<String> {
        let key = |id: &&str| format!("{id}.bsdf.brdf_0.reflectance.value");
        ids.iter().map(key).collect()
    };
    let transposed = |scene: &Scene, idle: Vec<String>| {
        let idle: Vec<&str> = idle.iter().map(String::as_str).collect();
        transposed(scene, Method::Reparam, &idle);
    };
    transposed(&small_balls(), idle(&["glass", "metal", "lamp", "floor"]));
    let balls = (0..9).map(|number| format!("ball{number}"));
    let all: Vec<String> = balls.chain(["floor".into()]).collect();
    let all: Vec<&str> = all.iter().map(String::as_str).collect();
    transposed(&balls_in_the_sun(), idle(&all));
    transposed(&leaves_seen_edge_on(), Vec::new());
}
