//! As `finite_differences`: what moves by matrices, instances, principal points and normals.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::scenes::*;
use glam::{Vec3, vec3};
use warpath::scene::source::Memory;
use warpath::scene::{Scene, load_from};

/// Two instances of a pair of boxes over a floor, under a sky.
const INSTANCES: &str = r#"<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="3"/></integrator>
  <sensor type="perspective" id="cam"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0.5 -4 2.5" target="0 0 0.3" up="0 0 1"/></transform>
    <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="20"/></film></sensor>
  <shape type="rectangle" id="floor"><transform name="to_world"><scale value="3"/></transform></shape>
  <shape type="shapegroup" id="pair">
    <shape type="cube" id="low"><transform name="to_world"><scale value="0.3"/></transform></shape>
    <shape type="cube" id="high"><transform name="to_world"><scale value="0.15"/><rotate x="1" angle="30"/>
      <translate x="0.1" z="0.6"/></transform>
      <bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.7, 0.3"/></bsdf></shape>
  </shape>
  <shape type="instance" id="left"><ref id="pair"/>
    <transform name="to_world"><rotate z="1" angle="20"/><translate x="-0.6" z="0.5"/></transform></shape>
  <shape type="instance" id="right"><ref id="pair"/>
    <transform name="to_world"><scale x="0.8" y="1.3" z="1"/><translate x="0.6" y="0.3" z="0.4"/></transform></shape>
  <emitter type="constant" id="sky"><rgb name="radiance" value="0.7, 0.8, 1"/></emitter>
</scene>"#;

fn instances() -> Scene {
    let files = Memory::new().with("s.xml", INSTANCES);
    load_from(&files, "s.xml", &[]).expect("a scene")
}

#[test]
fn an_instance_alone() {
    let moved = ("left.translation", [0.6, 0.3, 0.2].as_slice());
    check(&instances(), &[moved], 128, None, Fails);
}

#[test]
fn an_instance_that_turns_by_its_matrix() {
    let rows = [
        0.0, -0.5, 0.1, 0.2, 0.5, 0.0, 0.0, 0.1, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0,
    ];
    check(&instances(), &[("right.to_world", &rows)], 128, None, Fails);
}

#[test]
fn the_principal_point() {
    let scene = silhouette(GAUSSIAN);
    for key in ["x", "y"] {
        let key = format!("cam.principal_point_offset_{key}");
        check(&scene, &[(&key, &[1.0])], 128, None, Fails);
    }
}

#[test]
fn the_cameras_matrix() {
    let rows = [
        0.1, -0.3, 0.2, 0.5, 0.4, 0.2, 0.0, 0.1, 0.0, 0.1, 0.3, -0.2, 0.0, 0.0, 0.0, 0.0,
    ];
    let scene = silhouette(GAUSSIAN);
    check(&scene, &[("cam.to_world", &rows)], 128, None, Fails);
}

#[test]
fn vertex_normals() {
    let body = ball(2, vec3(0.1, 0.0, 0.5), 0.4);
    let normals: Vec<Vec3> = body
        .0
        .iter()
        .map(|p| (*p - vec3(0.1, 0.0, 0.5)).normalize())
        .collect();
    let turned: Vec<f32> = normals
        .iter()
        .flat_map(|n| vec3(0.3, n.x, -0.4 * n.y).to_array())
        .collect();
    let scene = small_floor().with_normals("ball", body, normals, [0.6, 0.5, 0.4]);
    let scene = lit(scene);
    check(
        &scene,
        &[("ball.vertex_normals", &turned)],
        128,
        Some(0.02),
        Agrees,
    );
}
