//! What is not said, and where the camera looks.

use super::{colour, scene, with_files};
use glam::Vec3A;
use warpath::scene::Filter;
use warpath::scene::source::Memory;

/// The horizontal opening angle of a sensor with these properties, degrees.
fn x_fov_deg(properties: &str) -> f32 {
    let sensor = format!("<sensor type=\"perspective\">{properties}</sensor>");
    with_files(&sensor, Memory::new(), &[]).sensors[0]
        .x_fov_rad
        .to_degrees()
}

#[test]
fn defaults_are_mitsubas() {
    let scene = scene(
        "<integrator type=\"path\"/><shape type=\"cube\"/><shape type=\"cube\"><emitter type=\"area\"/></shape>",
    );
    let sensor = &scene.sensors[0];
    assert_eq!((sensor.film.width, sensor.film.height), (768, 576));
    assert_eq!(sensor.film.crop_size, [768, 576]);
    assert_eq!(sensor.film.filter, Filter::Gaussian { stddev: 0.5 });
    assert!(!sensor.film.sample_border);
    assert_eq!((sensor.sample_count, sensor.seed), (4, 0));
    assert_eq!((sensor.near_clip, sensor.far_clip), (0.01, 10_000.0));
    assert_eq!(
        (scene.integrator.max_depth, scene.integrator.rr_depth),
        (u32::MAX, 5)
    );
    // A shape without a bsdf is grey; if it emits, black.
    assert_eq!(colour(&scene, scene.meshes[0].material), [0.5; 3]);
    assert_eq!(colour(&scene, scene.meshes[1].material), [0.0; 3]);
    assert!(!scene.materials[0].two_sided);
    assert_eq!(scene.constant(scene.area_lights[0].radiance), [1.0; 3]);
    let ids: Vec<&str> = scene.meshes.iter().map(|m| m.id.as_str()).collect();
    assert_eq!(ids, ["Cube", "Cube_1"]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn integrators_have_their_own_depths() {
    let depth = |integrator: &str| scene(integrator).integrator.max_depth;
    assert_eq!(depth("<integrator type=\"prb\"/>"), 6);
    assert_eq!(depth("<integrator type=\"direct\"/>"), 2);
    assert_eq!(depth("<integrator type=\"direct_projective\"/>"), 2);
    assert_eq!(depth("<integrator type=\"prbvolpath\"/>"), 6);
    assert_eq!(depth("<integrator type=\"ptracer\"/>"), u32::MAX);
    assert_eq!(
        depth(
            "<integrator type=\"prb_reparam\"><integer name=\"max_depth\" value=\"3\"/></integrator>"
        ),
        3
    );
}

/// Integrators around others say nothing of the image, and those of media are as good as `path`.
#[test]
fn the_innermost_integrator_counts() {
    let inner =
        "<integrator type=\"volpath\"><integer name=\"max_depth\" value=\"7\"/></integrator>";
    let aov = "<string name=\"aovs\" value=\"dd.y:depth\"/>";
    let scene = scene(&format!(
        "<integrator type=\"moment\"><integrator type=\"aov\">{aov}{inner}</integrator></integrator>"
    ));
    assert_eq!(scene.integrator.max_depth, 7);
    let said = |warning: &str| scene.warnings.iter().any(|w| w.contains(warning));
    assert_eq!(scene.warnings.len(), 3, "{:?}", scene.warnings);
    assert!(said("volpath") && said("moment") && said("aov"));
}

/// As files have them that name everything first.
#[test]
fn parts_may_stand_in_the_scene() {
    let scene = with_files(
        "<sampler type=\"independent\" id=\"many\"><integer name=\"sample_count\" value=\"99\"/></sampler>\
         <rfilter type=\"box\" id=\"filter\"/><film type=\"hdrfilm\" id=\"film\"><ref id=\"filter\"/></film>\
         <emitter type=\"area\" id=\"light\"><rgb name=\"radiance\" value=\"2\"/></emitter>\
         <sensor type=\"perspective\"><ref id=\"many\"/><ref id=\"film\"/></sensor>\
         <shape type=\"cube\"><ref id=\"light\"/></shape>",
        Memory::new(),
        &[],
    );
    assert_eq!(scene.sensors[0].sample_count, 99);
    assert_eq!(scene.sensors[0].film.filter, Filter::Box { radius: 0.5 });
    assert_eq!(scene.constant(scene.area_lights[0].radiance), [2.0; 3]);
}

/// Focal lengths are those of a frame of 36 by 24 millimetres, and 50 mm if nothing is said.
#[test]
fn lenses_have_focal_lengths() {
    let film = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"300\"/><integer name=\"height\" value=\"200\"/></film>";
    let of_frame = |length_mm: f32| 2.0 * (18.0 / length_mm).atan().to_degrees();
    let pinhole = "<float name=\"focus_distance\" value=\"3\"/>";
    assert!((x_fov_deg(&format!("{film}{pinhole}")) - of_frame(50.0)).abs() < 1e-4);
    for written in ["35mm", "35", " 35 mm"] {
        let lens = format!("<string name=\"focal_length\" value=\"{written}\"/>");
        assert!((x_fov_deg(&format!("{lens}{film}")) - of_frame(35.0)).abs() < 1e-4);
    }
}

#[test]
fn field_of_view_follows_its_axis() {
    let film = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/><integer name=\"height\" value=\"100\"/></film>";
    let fov = |axis: &str| {
        x_fov_deg(&format!(
            "<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"{axis}\"/>{film}"
        ))
    };
    let wide = 2.0 * (2.0 * 20f32.to_radians().tan()).atan().to_degrees();
    let diagonal = 2.0
        * (20f32.to_radians().tan() * 2.0 / 5f32.sqrt())
            .atan()
            .to_degrees();
    for (axis, expected) in [
        ("x", 40.0),
        ("larger", 40.0),
        ("y", wide),
        ("smaller", wide),
        ("diagonal", diagonal),
    ] {
        assert!((fov(axis) - expected).abs() < 1e-4, "{axis}: {}", fov(axis));
    }
}

#[test]
fn camera_looks_along_z_with_x_to_the_left() {
    let look = "<transform name=\"to_world\"><lookat origin=\"0 -4 0\" target=\"0 0 0\" up=\"0 0 1\"/></transform>";
    let sensor =
        format!("<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>{look}</sensor>");
    let to_world = with_files(&sensor, Memory::new(), &[]).sensors[0].to_world;
    assert_eq!(to_world.matrix3.z_axis, Vec3A::Y);
    assert_eq!(to_world.matrix3.x_axis, Vec3A::NEG_X);
    assert_eq!(to_world.translation, Vec3A::new(0.0, -4.0, 0.0));
}
