//! What Mitsuba takes and a strict reading would not: with a warning.

use super::{SENSOR, floats, scene, with_files};
use warpath::scene::Lens;
use warpath::scene::source::Memory;

fn warns(scene: &warpath::scene::Scene, of: &str) {
    let mut warnings = scene.warnings.iter();
    assert!(warnings.any(|w| w.contains(of)), "{:?}", scene.warnings);
}

#[test]
fn shapes_without_area_are_left_out() {
    let thin = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n";
    let files = Memory::new().with("s/thin.ply", thin);
    let shapes = "<shape type=\"ply\" id=\"thin\"><string name=\"filename\" value=\"thin.ply\"/>\
        <emitter type=\"area\"/></shape><shape type=\"cube\" id=\"lamp\"><emitter type=\"area\"/></shape>";
    let scene = with_files(&format!("{shapes}{SENSOR}"), files, &[]);
    assert_eq!((scene.meshes.len(), scene.area_lights.len()), (1, 1));
    assert_eq!(scene.meshes[0].area_light, Some(0));
    assert_eq!(scene.area_lights[0].mesh, 0);
    warns(&scene, "thin.ply");
}

#[test]
fn shapes_without_faces_are_left_out() {
    let header = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n\
        element face 0\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n";
    let none = header
        .replace("vertex 1", "vertex 0")
        .replace("0 0 0\n", "");
    let textured =
        "<bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"/></bsdf>";
    for (plugin, bytes) in [
        ("ply", header),
        ("ply", none.as_str()),
        ("obj", "v 0 0 0\n"),
    ] {
        for inside in ["<emitter type=\"area\"/>", textured] {
            let name = format!("bare.{plugin}");
            let files = Memory::new().with(format!("s/{name}"), bytes);
            let shapes = format!(
                "<shape type=\"{plugin}\"><string name=\"filename\" value=\"{name}\"/>{inside}</shape>\
                 <shape type=\"cube\"/>"
            );
            let scene = with_files(&format!("{shapes}{SENSOR}"), files, &[]);
            assert_eq!((scene.meshes.len(), scene.area_lights.len()), (1, 0));
            warns(&scene, &format!("{name}: the mesh has no faces"));
        }
    }
}

#[test]
fn bright_pictures_are_taken_as_they_are() {
    let files = Memory::new().with("s/bright.pfm", floats(2, 2, |x, _| [1.5 * x as f32; 3]));
    let shape = "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture type=\"bitmap\" name=\"reflectance\">\
        <string name=\"filename\" value=\"bright.pfm\"/></texture></bsdf></shape>";
    let scene = with_files(&format!("{shape}{SENSOR}"), files, &[]);
    let picture = scene.textures.iter().find(|t| t.varies()).unwrap();
    assert_eq!(picture.texels[1], [1.5; 3]);
    warns(&scene, "up to 1.5");
}

#[test]
fn of_a_negative_eta_the_amount_counts() {
    let scene = scene(
        "<shape type=\"cube\"><bsdf type=\"conductor\"><rgb name=\"eta\" value=\"0.2, -0.01, 0.3\"/>\
         <rgb name=\"k\" value=\"3, 4, 5\"/></bsdf></shape>",
    );
    let eta = scene.textures.iter().find(|t| t.key.ends_with(".eta"));
    assert_eq!(eta.unwrap().texels[0], [0.2, 0.01, 0.3]);
    warns(&scene, "negative");
}

#[test]
fn a_scene_without_a_sensor_is_seen_as_a_whole() {
    let scene = with_files("<shape type=\"cube\"/>", Memory::new(), &[]);
    let sensor = &scene.sensors[0];
    assert_eq!(sensor.lens, Lens::Pinhole);
    let toward = sensor.to_world.inverse();
    for &position in &scene.meshes[0].positions {
        let seen = toward.transform_point3(position);
        let tangent = (0.5 * sensor.x_fov_rad).tan();
        assert!(seen.z > sensor.near_clip && seen.z < sensor.far_clip);
        assert!(seen.x.abs() < tangent * seen.z && seen.y.abs() < 0.75 * tangent * seen.z);
    }
    warns(&scene, "no sensor");
}

#[test]
fn numbers_of_samples_matter_where_they_leave_light_out() {
    let direct = |inside: &str| {
        let text = format!(
            "<scene version=\"3.0.0\"><integrator type=\"direct\"><integer name=\"emitter_samples\" value=\"0\"/>\
             </integrator><shape type=\"cube\"/>{inside}{SENSOR}</scene>"
        );
        warpath::scene::load_from(&Memory::new().with("s.xml", text), "s.xml", &[])
    };
    assert!(
        direct("<emitter type=\"constant\"/>")
            .unwrap()
            .warnings
            .is_empty()
    );
    let refused = direct("<emitter type=\"point\"/>").unwrap_err().to_string();
    assert!(refused.contains("emitter_samples"), "{refused}");
}

/// As Mitsuba 3.9.1 renders them.
#[test]
fn a_colour_for_a_number_is_its_mean() {
    let scene = scene(
        "<bsdf type=\"principled\" id=\"paint\">\
           <rgb name=\"metallic\" value=\"0.5, 0.25, 0\"/></bsdf>\
         <bsdf type=\"mask\" id=\"veil\"><rgb name=\"opacity\" value=\"0.25, 0.5, 0.75\"/>\
           <ref id=\"paint\"/></bsdf>\
         <shape type=\"cube\"><ref id=\"veil\"/></shape>",
    );
    for (key, mean) in [("veil.opacity", 0.5), ("paint.metallic", 0.25)] {
        let texture = scene.textures.iter().find(|t| t.key == key);
        let texture = texture.expect("a texture");
        assert_eq!(texture.texels, [[mean; 3]], "{key}");
    }
}

#[test]
fn what_editors_leave_unseen_is_no_text() {
    let scene = scene("<shape type=\"cube\"/>\u{200b}<emitter type=\"constant\"/>\u{feff}");
    assert_eq!(scene.meshes.len(), 1);
}
