//! A lamp of many triangles.

use crate::made::{Density, Made};
use crate::mesh::{Mesh, Point};
use crate::shapes::icosphere;
use crate::xml::{Scene, floor, ply};

/// A ball's shadow under a round lamp of 20, 320 and 20480 triangles, each of which is a light.
pub fn lamp(density: Density) -> Made {
    let light = r#"  <shape type="ply" id="lamp">
    <string name="filename" value="meshes/lamp.ply"/><boolean name="face_normals" value="true"/>
    <emitter type="area"><rgb name="radiance" value="22, 20, 18"/></emitter>
  </shape>
"#;
    Made {
        scene: Scene {
            name: "lamp",
            comment: "A ball and its soft shadow under a round lamp, which is out of sight.",
            max_depth: 2,
            fov: 32.0,
            origin: "0, -5, 2.6",
            target: "0.1, 0, 0.35",
            body: ply("ball", "ball", "false", "", "0.3, 0.45, 0.7") + &floor(4.0) + light,
        },
        meshes: vec![
            ("ball", ball([0.0, 0.0, 0.9], 0.4, 3)),
            ("lamp", ball([-0.8, -0.5, 3.2], 0.4, density.of([0, 2, 5]))),
        ],
        bent: "ball",
        bands: false,
    }
}

/// An icosahedron cut so many times.
pub fn ball(centre: Point, radius: f64, cuts: usize) -> Mesh {
    let mut mesh = icosphere(cuts);
    for point in &mut mesh.points {
        *point = std::array::from_fn(|c| centre[c] + radius * point[c]);
    }
    mesh
}
