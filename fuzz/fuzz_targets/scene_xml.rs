//! Any bytes as a scene file, which can reference a mesh, a picture, another scene file and itself.
#![no_main]

use libfuzzer_sys::fuzz_target;
use warpath::scene::source::Memory;
use warpath::scene::{load_from, parameters};

const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
/// Three rows of two grey numbers.
const PICTURE: &[u8] = b"Pf\n2 3\n-1.0\n\0\0\0?\0\0\0?\0\0\0?\0\0\0?\0\0\0?\0\0\0?";
const PART: &str = "<scene version=\"3.0.0\"><default name=\"n\" value=\"3\"/><include filename=\"s.xml\"/></scene>";

fuzz_target!(|bytes: &[u8]| {
    let files = Memory::new()
        .with("s.xml", bytes)
        .with("m.obj", OBJ)
        .with("m.pfm", PICTURE)
        .with("part.xml", PART)
        .with(
            "paint.xml",
            "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"paint\"/>",
        );
    if let Ok(scene) = load_from(&files, "s.xml", &[]) {
        let keys = parameters::list(&scene);
        assert!(keys.iter().all(|p| !p.key.is_empty()));
    }
});
