//! Files that are read, and what of them is not.

use super::{SENSOR, scene, with_files};
use std::io;
use std::path::Path;
use warpath::scene::source::{FileSource, Memory};
use warpath::scene::{SceneError, load_from};

#[test]
fn includes_paths_and_defines_resolve() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files = Memory::new()
        .with("s/parts/shapes.xml", "<scene version=\"3.0.0\"><default name=\"n\" value=\"7\"/>\
               <shape type=\"obj\" id=\"near\"><string name=\"filename\" value=\"near.obj\"/></shape>\
               <shape type=\"obj\" id=\"far\"><string name=\"filename\" value=\"far_$n.obj\"/></shape></scene>")
        .with("s/paint.xml", "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"paint\"/>")
        .with("s/parts/near.obj", triangle)
        .with("s/library/far_8.obj", triangle);
    let inside = format!(
        "<path value=\"library\"/><include filename=\"parts/shapes.xml\"/><include filename=\"paint.xml\"/>{SENSOR}"
    );
    let scene = with_files(&inside, files, &[("n", "8")]);
    assert_eq!(scene.meshes.len(), 2);
    assert_eq!(scene.materials.last().unwrap().key, "paint");
}

#[test]
fn what_was_not_read_is_said() {
    let scene = scene(
        "<integrator type=\"path\">\n  <integer name=\"max_dept\" value=\"4\"/></integrator>",
    );
    assert_eq!(
        scene.warnings,
        [
            "s/s.xml:3:3: property \"max_dept\" of <integrator type=\"path\"> was not read; the nearest one it reads is \"max_depth\""
        ]
    );
}

#[test]
fn the_hash_is_of_what_was_read() {
    let hash = |n: &str, obj: &str| {
        let inside = format!(
            "<default name=\"n\" value=\"1\"/><shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>\
             <transform name=\"to_world\"><translate x=\"$n\"/></transform></shape>{SENSOR}"
        );
        with_files(&inside, Memory::new().with("s/m.obj", obj), &[("n", n)]).hash
    };
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(hash("2", obj), hash("2", obj));
    assert_ne!(hash("2", obj), hash("3", obj));
    assert_ne!(hash("2", obj), hash("2", &obj.replace("1 0 0", "2 0 0")));
}

/// A disk on which nothing can be read.
struct Broken;

impl FileSource for Broken {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::PermissionDenied.into())
    }

    fn exists(&self, _: &Path) -> bool {
        true
    }
}

#[test]
fn a_file_that_cannot_be_read_is_no_bad_input() {
    let error = load_from(&Broken, "s.xml", &[]).unwrap_err();
    assert!(
        error.is_io() && error.to_string().starts_with("s.xml: "),
        "{error}"
    );
    let missing = load_from(&Memory::new(), "s.xml", &[]).unwrap_err();
    assert!(matches!(missing, SceneError::Missing { .. }) && !missing.is_io());
}
