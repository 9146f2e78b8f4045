//! What hangs together in meshes.

use common::scenes::*;
use glam::{Vec3, dvec3, vec3};
use warpath::discontinuity::adjacency::Adjacency;
use warpath::discontinuity::pieces::Pieces;
use warpath::trace::geometry::Geometry;

/// Two triangles with a common edge, whose vertices are written twice; and one that touches them in
/// a corner alone, in the same mesh.
#[test]
fn pieces_share_edges() {
    let corners = [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 2.0, 0.0],
        [0.0, 2.0, 0.0],
        [1.0, 0.0, 0.0],
        [1.0, 2.0, 0.0],
        [1.0, 2.0, 0.0],
        [3.0, 2.0, 0.0],
        [3.0, 4.0, 0.0],
    ];
    let mesh = (
        corners.map(Vec3::from).to_vec(),
        vec![[0, 1, 2], [3, 4, 5], [6, 7, 8]],
    );
    let scene = scene(vec3(0.0, -4.0, 2.0), Vec3::ZERO, 40.0, [4; 2], BOX);
    let scene = scene.solid("mesh", mesh, [0.5; 3]).solid(
        "ball",
        ball(1, vec3(0.0, 0.0, 5.0), 0.5),
        [0.5; 3],
    );
    let geometry = Geometry::new(&scene);
    let pieces = Pieces::new(&geometry, &Adjacency::new(&geometry));
    for vertex in 0..6 {
        let around = pieces.around(vertex);
        assert_eq!(around.centre, dvec3(0.5, 1.0, 0.0), "{vertex}");
        assert_eq!(around.radius, 1.25f64.sqrt(), "{vertex}");
    }
    for vertex in 6..9 {
        let around = pieces.around(vertex);
        assert_eq!(around.centre, dvec3(2.0, 3.0, 0.0), "{vertex}");
    }
    for vertex in 9..geometry.positions.len() as u32 {
        assert!((pieces.around(vertex).centre - dvec3(0.0, 0.0, 5.0)).length() < 1e-6);
    }
}

/// What is not convex may hide parts of itself.
#[test]
fn what_may_hide_itself() {
    let [near, far] = [-2.0, 2.0].map(|x| ball(1, vec3(x, 0.0, 0.0), 1.0));
    let mut pair = near.clone();
    pair.0.extend(far.0);
    pair.1
        .extend(far.1.iter().map(|t| t.map(|v| v + near.0.len() as u32)));
    let inside_out = (
        near.0.clone(),
        near.1.iter().map(|&[a, b, c]| [a, c, b]).collect(),
    );
    let cases = [
        ("ball", near, false),
        ("ball inside out", inside_out, false),
        ("box", cuboid(Vec3::ONE), false),
        ("plane", floor(1.0, 0.0), false),
        ("pair", pair, true),
        ("corner", l_shape(0.4, 0.6), true),
        ("thorns", spiky(Vec3::ZERO, 1.0, [1.0, 0.5]), true),
    ];
    for (what, shape, expected) in cases {
        let scene = scene(Vec3::ZERO, Vec3::Y, 30.0, [4; 2], GAUSSIAN).solid("it", shape, [0.5; 3]);
        let geometry = Geometry::new(&scene);
        let pieces = Pieces::new(&geometry, &Adjacency::new(&geometry));
        assert_eq!(pieces.may_hide_itself(0), expected, "{what}");
    }
}
