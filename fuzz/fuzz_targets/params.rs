//! Any keys and values for tangents, steps and settings of a small scene.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::sync::OnceLock;
use warpath::scene::parameters::{Parameter, apply, displace, find, list, reduce, tangent, wanted};
use warpath::scene::source::Memory;
use warpath::scene::{Scene, load_from};

const SCENE: &str = "<scene version=\"3.0.0\"><sensor type=\"perspective\" id=\"cam\"><float name=\"fov\" value=\"40\"/>\
    </sensor><shape type=\"obj\" id=\"obj\"><string name=\"filename\" value=\"m.obj\"/><emitter type=\"area\"/></shape>\
    <shape type=\"cube\" id=\"cube\"><bsdf type=\"roughdielectric\"><texture type=\"checkerboard\" name=\"alpha\"/></bsdf></shape>\
    <shape type=\"cube\"><bsdf type=\"roughconductor\"><string name=\"material\" value=\"Au\"/></bsdf></shape>\
    <emitter type=\"point\" id=\"bulb\"/><emitter type=\"directional\" id=\"sun\"/><emitter type=\"constant\" id=\"env\"/></scene>";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";

fn scene() -> &'static (Scene, Vec<Parameter>) {
    static LOADED: OnceLock<(Scene, Vec<Parameter>)> = OnceLock::new();
    LOADED.get_or_init(|| {
        let files = Memory::new().with("s.xml", SCENE).with("m.obj", OBJ);
        let scene = load_from(&files, "s.xml", &[]).expect("the fixed scene loads");
        let parameters = list(&scene);
        (scene, parameters)
    })
}

fuzz_target!(|bytes: &[u8]| {
    let (scene, parameters) = scene();
    let Some((&first, rest)) = bytes.split_first() else {
        return;
    };
    // Half of the inputs name a key that exists, the others spell one.
    let (key, rest) = match parameters.get(usize::from(first)) {
        Some(parameter) => (parameter.key.clone(), rest),
        None => {
            let (name, rest) = rest.split_at(rest.len() / 2);
            (String::from_utf8_lossy(name).into_owned(), rest)
        }
    };
    let numbers = rest
        .chunks_exact(4)
        .map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]]));
    let values: Vec<f32> = numbers.collect();
    let Ok(parameter) = find(scene, &key) else {
        assert!(tangent(scene, &[(&key, &values)], 0).is_err());
        return;
    };
    if let Ok(tangent) = tangent(scene, &[(&key, &values)], 0) {
        let gradient = reduce(scene, &parameter, &tangent);
        assert_eq!(gradient.len(), parameter.len());
    }
    wanted(scene, std::slice::from_ref(&parameter), 0).expect("the parameter is differentiable");
    let _ = displace(scene, &[(parameter.clone(), &values)], 1e-3);
    let mut changed = scene.clone();
    if apply(&mut changed, &parameter, &values).is_ok() {
        let _ = list(&changed);
    }
});
