//! Any bytes as a PLY file: alone, and smoothly shaded in a scene.
#![no_main]

use libfuzzer_sys::fuzz_target;
use warpath::scene::source::Memory;
use warpath::scene::{load_from, mesh};

const SCENE: &str = "<scene version=\"3.0.0\"><sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>\
    <shape type=\"ply\"><string name=\"filename\" value=\"m.ply\"/><transform name=\"to_world\"><scale x=\"-3\" y=\"2\"/>\
    </transform></shape></scene>";

fuzz_target!(|bytes: &[u8]| {
    if let Ok(mesh) = mesh::ply::parse(bytes) {
        let vertices = mesh.positions.len();
        assert!(mesh.positions.iter().all(|p| p.is_finite()));
        assert!(
            mesh.triangles
                .iter()
                .flatten()
                .all(|&i| (i as usize) < vertices)
        );
        assert!(mesh.normals.is_none_or(|n| n.len() == vertices));
        assert!(mesh.uvs.is_none_or(|u| u.len() == vertices));
        let files = Memory::new().with("s.xml", SCENE).with("m.ply", bytes);
        let _ = load_from(&files, "s.xml", &[]);
    }
});
