//! Any bytes as an OBJ file: alone, and smoothly shaded in a scene, with a texture.
#![no_main]

use libfuzzer_sys::fuzz_target;
use warpath::scene::source::Memory;
use warpath::scene::{load_from, mesh};

const SCENE: &str = "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>\
    <shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>\
    <bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"/></bsdf></shape></scene>";

fuzz_target!(|bytes: &[u8]| {
    for (normals, uvs) in [(true, false), (false, true), (true, true)] {
        let reads = mesh::obj::Reads { normals, uvs };
        if let Ok(mesh) = mesh::obj::parse(bytes, reads) {
            let vertices = mesh.positions.len();
            assert!(
                mesh.triangles
                    .iter()
                    .flatten()
                    .all(|&i| (i as usize) < vertices)
            );
            assert!(mesh.normals.is_none_or(|n| n.len() == vertices));
            assert!(mesh.uvs.is_none_or(|u| u.len() == vertices));
            let files = Memory::new().with("s.xml", SCENE).with("m.obj", bytes);
            let _ = load_from(&files, "s.xml", &[]);
        }
    }
});
