//! Any bytes as an OBJ file: alone, and smoothly shaded in a scene.
#![no_main]

use libfuzzer_sys::fuzz_target;
use warpath::scene::source::Memory;
use warpath::scene::{load_from, mesh};

const SCENE: &str = "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>\
    <shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/></shape></scene>";

fuzz_target!(|bytes: &[u8]| {
    for ignore_normals in [false, true] {
        if let Ok(mesh) = mesh::obj::parse(bytes, ignore_normals) {
            let vertices = mesh.positions.len();
            assert!(
                mesh.triangles
                    .iter()
                    .flatten()
                    .all(|&i| (i as usize) < vertices)
            );
            assert!(mesh.normals.is_none_or(|n| n.len() == vertices));
            let files = Memory::new().with("s.xml", SCENE).with("m.obj", bytes);
            let _ = load_from(&files, "s.xml", &[]);
        }
    }
});
