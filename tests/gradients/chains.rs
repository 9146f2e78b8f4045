//! What is seen through smooth surfaces, against finite differences.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use glam::{Vec3, vec3};
use warpath::scene::Scene;

const FINE: f64 = 0.01;
const MOVED: [f32; 3] = [1.0, 0.0, 0.2];

fn checked(scene: &Scene, spp: u32, key: &str, by: &[f32], step: f64) {
    println!("{key}");
    check_to(FINE, scene, &[(key, by)], spp, Some(step), Fails);
}

/// A black plate before the sky that the camera sees in the floor alone.
fn over_a_mirror() -> Scene {
    let plate = parallelogram(vec3(-0.3, 1.9, 1.1), Vec3::X * 0.8, Vec3::Z * 0.7);
    let scene = small_floor()
        .solid("plate", plate, [0.0; 3])
        .constant_environment(SKY);
    scene.depth(2).mirror("floor")
}

#[test]
fn an_edge_in_a_flat_mirror() {
    let scene = over_a_mirror();
    checked(&scene, 64, "plate.translation", &MOVED, 0.01);
    checked(&scene, 64, "floor.rotation", &[0.5, 0.3, 0.0], 0.01);
    checked(&scene, 64, "cam.translation", &MOVED, 0.01);
}

/// A ball of metal or glass in front of a plate, between which and the sky it sees edges.
fn ball_before_a_plate() -> Scene {
    let plate = parallelogram(vec3(-0.7, 1.0, -0.4), Vec3::X * 0.9, Vec3::Z * 0.9);
    let near = parallelogram(vec3(-1.0, -2.0, -0.1), Vec3::X * 0.8, Vec3::Z * 0.9);
    scene(
        vec3(0.3, -3.4, 0.9),
        vec3(0.0, 0.0, 0.0),
        22.0,
        [16; 2],
        GAUSSIAN,
    )
    .smooth("ball", ball(3, Vec3::ZERO, 0.5), [0.5; 3])
    .solid("plate", plate, [0.0; 3])
    .solid("near", near, [0.0; 3])
    .constant_environment(SKY)
}

#[test]
fn an_edge_in_a_curved_mirror() {
    let scene = ball_before_a_plate().depth(2).mirror("ball");
    checked(&scene, 64, "near.translation", &MOVED, 0.01);
    checked(&scene, 64, "ball.translation", &MOVED, 0.01);
}

#[test]
fn an_edge_behind_a_lens() {
    let scene = ball_before_a_plate().depth(4).clear("ball");
    checked(&scene, 64, "plate.translation", &MOVED, 0.01);
    checked(&scene, 64, "ball.translation", &MOVED, 0.01);
    checked(&scene, 64, "ball.bsdf.eta", &[1.0], 0.01);
}

fn room_with(ball_kind: &str, mirror: &str) -> Scene {
    let rough = |s: Scene, id: &str, kind: &str| match kind {
        "mirror" => s.mirror(id),
        "clear" => s.clear(id),
        "metal" => s.metal(id, 0.1, warpath::scene::Distribution::Ggx),
        "glass" => s.glass(id, 0.1),
        "plastic" => s.plastic(id, None),
        "null" => s.null(id),
        _ => s,
    };
    let s = scene(vec3(0.0, -3.9, 1.0), vec3(0.0, 0.0, 1.0), 39.0, [24; 2], GAUSSIAN)
        .solid("floor", floor(1.0, 0.0), [0.7; 3])
        .solid("roof", placed(floor(1.0, 0.0), vec3(180.0, 0.0, 0.0), vec3(0.0, 0.0, 2.0)), [0.7; 3])
        .solid("back", parallelogram(vec3(-1.0, 1.0, 0.0), Vec3::X * 2.0, Vec3::Z * 2.0), [0.7; 3])
        .solid("left", parallelogram(vec3(-1.0, -1.0, 0.0), Vec3::Y * 2.0, Vec3::Z * 2.0), [0.6, 0.1, 0.1])
        .solid("right", parallelogram(vec3(1.0, -1.0, 0.0), Vec3::Z * 2.0, Vec3::Y * 2.0), [0.1, 0.5, 0.1])
        .smooth("ball", ball(3, vec3(0.4, -0.3, 0.42), 0.4), [0.5; 3])
        .solid("block", placed(cuboid(vec3(0.3, 0.3, 0.55)), vec3(0.0, 0.0, 20.0), vec3(-0.4, 0.3, 0.56)), [0.7; 3])
        .light("lamp", ceiling(vec3(0.0, 0.0, 1.99), 0.3), [12.0, 11.0, 9.0])
        .depth(std::env::var("DEPTH").ok().and_then(|s| s.parse().ok()).unwrap_or(6));
    let s = rough(s, "ball", ball_kind);
    rough(s, "block", mirror)
}

#[test]
fn explore() {
    let var = |k: &str, d: &str| std::env::var(k).unwrap_or(d.into());
    let number = |k: &str, d: &str| var(k, d).parse::<f64>().unwrap();
    let sc = match var("SCENE", "flat").as_str() {
        "flat" => over_a_mirror(),
        "curved" => ball_before_a_plate().depth(2).mirror("ball"),
        "lens" => ball_before_a_plate().depth(4).clear("ball"),
        "room" => room_with(&var("BALL", "clear"), &var("BLOCK", "mirror")),
        _ => {
            let s = close_up().constant_environment(SKY).depth(number("DEPTH", "3") as u32);
            match var("SCENE", "").as_str() {
                "plastic" => s.plastic("floor", None),
                "nullblock" => s.null("block"),
                "mirrorfloor" => s.mirror("floor"),
                "mirrorblock" => s.mirror("block"),
                "clearblock" => s.clear("block"),
                "rough" => s.metal("floor", 0.1, warpath::scene::Distribution::Ggx),
                _ => s,
            }
        }
    };
    let key = var("KEY", "plate.translation");
    let by: Vec<f32> = var("BY", "1,0,0.2").split(',').map(|x| x.parse().unwrap()).collect();
    let along = common::direction(&sc, &[(&key, &by)]);
    let runs = number("RUNS", "12") as u64;
    let spp = number("SPP", "256") as u32;
    let h = number("STEP", "0.01");
    use warpath::methods::Method;
    let go = |m: Method, spp: u32, first: u64| -> Vec<Vec<f64>> {
        (first..first + runs).map(|seed| match m {
            Method::Fd => common::differences(&sc, &common::settings(&sc, m, spp, seed), &along, h),
            _ => common::gradient(&sc, &common::settings(&sc, m, spp, seed), &along),
        }).collect()
    };
    let fd = go(Method::Fd, (number("FD", "4") * spp as f64) as u32, 1000);
    let rms = |all: &[Vec<f64>]| {
        let n = all[0].len();
        let mean: Vec<f64> = (0..n).map(|i| all.iter().map(|r| r[i]).sum::<f64>() / all.len() as f64).collect();
        let var = (0..n).map(|i| all.iter().map(|r| (r[i] - mean[i]).powi(2)).sum::<f64>() / (all.len() - 1) as f64).sum::<f64>() / n as f64;
        ((mean.iter().map(|m| m * m).sum::<f64>() / n as f64).sqrt(), var.sqrt())
    };
    println!("fd rms, sd: {:?}", rms(&fd));
    for m in [Method::Reparam, Method::Interior] {
        let ours = go(m, spp, 1);
        println!("{m:?} {key} {by:?}: {:.4?} rms,sd {:.4?}", common::statistics::Agreement::new(&ours, &fd), rms(&ours));
    }
    if let Ok(path) = std::env::var("DUMP") {
        let ours = go(Method::Reparam, spp, 1);
        let mean = |all: &[Vec<f64>]| -> Vec<f64> { (0..all[0].len()).map(|i| all.iter().map(|r| r[i]).sum::<f64>() / all.len() as f64).collect() };
        let (a, b) = (mean(&ours), mean(&fd));
        let text: Vec<String> = a.iter().zip(&b).map(|(x, y)| format!("{x} {y}")).collect();
        std::fs::write(path, text.join("\n")).unwrap();
    }
}
