//! Finite differences with ten times the samples of the short tests: errors of less than a percent
//! show.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::scenes::*;
use glam::vec3;

const SAMPLES: u32 = 1024;

#[test]
fn shadows() {
    let motions: [(&str, &[f32]); 6] = [
        ("block.translation", &[1.0, 0.2, 0.1]),
        ("block.rotation", &[0.5, 0.3, 1.0]),
        ("block.scale", &[1.0]),
        ("lamp.translation", &[1.0, 0.3, -0.2]),
        ("floor.rotation", &[0.3, 0.5, 1.0]),
        ("cam.translation", &[1.0, 0.2, -0.3]),
    ];
    for motion in motions {
        check(&shadow(), &[motion], SAMPLES, None, Fails);
    }
}

#[test]
fn silhouettes() {
    for motion in [
        ("block.translation", [1.0, 0.2, 0.4]),
        ("block.rotation", [0.3, 1.0, 0.5]),
    ] {
        let motion: (&str, &[f32]) = (motion.0, &motion.1);
        check(&silhouette(GAUSSIAN), &[motion], SAMPLES, None, Fails);
        check(&silhouette(BOX), &[motion], SAMPLES, Some(2e-3), Fails);
    }
}

#[test]
fn concave_and_intersecting() {
    let shape = placed(
        l_shape(0.4, 0.6),
        vec3(0.0, 0.0, 25.0),
        vec3(0.0, 0.0, -0.1),
    );
    let scene = lit(floor_seen(20, GAUSSIAN).solid("corner", shape, [0.5, 0.5, 0.7]));
    check(
        &scene,
        &[("corner.translation", &[1.0, 0.2, 0.1])],
        SAMPLES,
        None,
        Fails,
    );
    check(
        &scene,
        &[("corner.rotation", &[0.8, 0.5, 1.0])],
        SAMPLES,
        None,
        Fails,
    );
}

#[test]
fn indirect_light() {
    for depth in [3, 5] {
        check(
            &room(depth),
            &[("block.translation", &[1.0, 0.2, 0.1])],
            SAMPLES / 2,
            None,
            Fails,
        );
        check(
            &room(depth),
            &[("lamp.translation", &[0.5, 0.3, 1.0])],
            SAMPLES / 2,
            None,
            Fails,
        );
    }
}
