//! What borders bring, added up as sizes, to which what is not found is related.

use common::scenes::*;
use common::{Quiet, direction, settings};
use glam::vec3;
use warpath::methods::{Image, Method, Objective, Statistics, backward, forward};
use warpath::scene::parameters;
use warpath::scene::{Rgb, Scene, load};

/// A lamp before nothing: all that changes as it moves sideways is its left and its right edge.
fn lamp_alone() -> Scene {
    let from = vec3(-0.7, 0.0, -0.6);
    let lamp = parallelogram(from, vec3(1.4, 0.0, 0.0), vec3(0.0, 0.0, 1.2));
    let size = [20; 2];
    scene(vec3(0.0, -4.0, 0.0), vec3(0.0, 0.0, 0.0), 40.0, size, BOX)
        .depth(1)
        .light("lamp", lamp, [3.0, 2.0, 1.0])
}

fn length(c: &Rgb) -> f64 {
    c.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt()
}

fn brought(statistics: &Statistics) -> f64 {
    statistics.borders.all().brought
}

/// Nothing cancels, so that sizes add up to that of the gradient.
#[test]
fn sizes_add_up_to_the_gradient() {
    let scene = lamp_alone();
    let settings = settings(&scene, Method::Reparam, 256, 3);
    let along = direction(&scene, &[("lamp.translation", &[1.0, 0.0, 0.0])]);
    let image = forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
    let all: f64 = image.gradient.pixels.iter().map(length).sum();
    let of_forward = brought(&image.statistics) / all;
    // Of the rows in the middle, where there are no other edges.
    let sign = |c: f32| if c == 0.0 { 0.0 } else { c.signum() };
    let pixels = image.gradient.pixels.iter().enumerate();
    let of_pixel = |(i, p): (usize, &Rgb)| match i / image.gradient.width {
        8..12 => p.map(sign),
        _ => [0.0; 3],
    };
    let signs = Image {
        pixels: pixels.map(of_pixel).collect(),
        ..image.gradient.clone()
    };
    let wanted = [parameters::find(&scene, "lamp.translation").expect("a key")];
    let objective = Objective::Adjoint(&signs);
    let back = backward(&scene, &settings, &wanted, &objective, &Quiet).expect("a gradient");
    let along_x = f64::from(back.gradient.by(&scene, &wanted[0])[0]);
    let of_backward = brought(&back.statistics) / along_x;
    println!("{of_forward} {of_backward}");
    assert!((of_forward - 1.0).abs() < 1e-4);
    // A vertex is as good as one that moves across the plane of eye and edge, which is at an angle
    // to x of as much as the edge is seen from the middle.
    let cosine = 4.0 / (16.0f64 + 0.49).sqrt();
    assert!((of_backward * cosine - 1.0).abs() < 1e-4);
    assert_eq!(image.statistics.missing_part(), None);
}

/// Facets of a ball of glass lose some chains.
#[test]
fn what_is_lost_has_a_part() {
    let scene = load("scenes/materials/dielectric.xml", &[]).expect("a scene");
    let settings = settings(&scene, Method::Reparam, 16, 3);
    let along = direction(&scene, &[("cam.translation", &[1.0, 0.0, 0.0])]);
    let image = forward(&scene, &settings, &along, &Quiet).expect("a gradient image");
    let statistics = image.statistics;
    let lost = statistics.rejected["silhouette_not_found"];
    let all = statistics.borders.all();
    assert_eq!(lost, all.lost);
    let part = statistics.missing_part().expect("a part");
    println!("{lost} of {}: {part}", all.found);
    let of_all = lost as f64 / all.found as f64;
    assert!(part > 0.1 * of_all && part < 10.0 * of_all);
}
