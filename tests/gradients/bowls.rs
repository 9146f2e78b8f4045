//! A surface that is concave hides up to the plane of the triangle that looks, below which shading
//! normals look too.

use common::comparison::{Interior::Fails, check_to};
use common::materials::Paint;
use common::scenes::*;
use common::shapes::Shape;
use common::{Quiet, direction, settings};
use glam::{Vec3, vec3};
use warpath::methods::{Method, forward};

use warpath::scene::Scene;

/// The lower half of a coarse ball with shading normals, seen from above.
fn bowl() -> Scene {
    let (positions, triangles): Shape = ball(2, Vec3::ZERO, 1.0);
    let low = |t: &[u32; 3]| t.iter().map(|&v| positions[v as usize].z).sum::<f32>() < -0.1;
    let triangles = triangles.into_iter().filter(low).collect();
    scene(
        vec3(0.3, -1.5, 3.0),
        vec3(0.0, 0.0, -0.5),
        40.0,
        [8; 2],
        GAUSSIAN,
    )
    .smooth("bowl", (positions, triangles), [0.7, 0.6, 0.5])
    .depth(2)
    .sunny()
}

const TURN: [(&str, &[f32]); 1] = [("bowl.rotation", &[1.0, 0.4, 0.3])];

#[test]
fn by_differences() {
    check_to(0.03, &bowl(), &TURN, 1024, None, Fails);
}

#[test]
fn no_end_is_lost() {
    let scene = bowl();
    let along = direction(&scene, &TURN);
    let asked = settings(&scene, Method::Reparam, 256, 1);
    let found = forward(&scene, &asked, &along, &Quiet).expect("a gradient");
    let rays = &found.statistics.rays;
    println!("{rays:?}, {:?}", found.statistics.rejected);
    assert_eq!(found.statistics.rejected.get("silhouette_not_found"), None);
    // The ends of shadows were once crept up to, a thousandth of a cell at a time.
    assert!(rays["probe"] < 2 * rays["sky_cell"], "{rays:?}");
}
