//! Edges just behind an outline: what is hidden brings nothing, however near the outline probes
//! would look.
//!
//! The ridge of a roof lies right behind the border of a card, less than probes keep apart, and a
//! second card ends a little before it: from the first outline that a walk comes to, the ridge
//! seems to be seen. The sun lights each side of the roof evenly, and only one of them is seen, so
//! that nothing changes when the roof moves along x. The cards' shadows lie beyond the film.

use common::scenes::*;
use common::{direction, gradient, settings};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::{DeltaLightKind, Scene};

const RIDGE: f32 = 0.1;

/// What the lower card hides beyond the ridge, in the roof's x.
fn roof_behind_cards(hidden: f32) -> Scene {
    let (far, height) = (20.0, 10.0);
    let ridge = |y: f32| vec3(RIDGE, y, 0.0);
    let foot = |side: f32, y: f32| vec3(RIDGE + side * far, y, -far);
    let positions = vec![
        foot(-1.0, -far),
        ridge(-far),
        foot(1.0, -far),
        foot(-1.0, far),
        ridge(far),
        foot(1.0, far),
    ];
    let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    let card = |end: f32, nearness: f32| {
        parallelogram(
            vec3((1.0 - nearness) * end, -far, nearness * height),
            vec3(0.0, 2.0 * far, 0.0),
            vec3(-far, 0.0, 0.0),
        )
    };
    let sun = DeltaLightKind::Directional {
        direction: vec3(-0.8, 0.0, -1.0),
    };
    scene(vec3(0.0, 0.0, height), Vec3::ZERO, 12.0, [12; 2], BOX)
        .solid("roof", (positions, triangles), [0.5; 3])
        .solid("lower", card(RIDGE + hidden, 0.25), [0.0; 3])
        .solid("upper", card(RIDGE - 2e-4, 0.5), [0.0; 3])
        .delta_light("sun", sun, [3.0; 3])
}

fn largest(scene: &Scene) -> f64 {
    let along = direction(scene, &[("roof.translation", &[1.0, 0.0, 0.0])]);
    let image = gradient(scene, &settings(scene, Method::Reparam, 64, 1), &along);
    image.iter().fold(0.0, |most, x| most.max(x.abs()))
}

#[test]
fn a_ridge_behind_an_outline() {
    assert!(largest(&roof_behind_cards(-0.05)) > 0.1);
    assert_eq!(largest(&roof_behind_cards(4e-6)), 0.0);
}
