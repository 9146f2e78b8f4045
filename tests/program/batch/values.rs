//! `set`: values in place of the scene's.

use crate::jobs::{files, result, results, run, write};
use crate::workplace::{SCENE, npy, workplace};
use serde_json::{Value, json};
use std::path::Path;

/// What a job of this kind on scene `s.xml` gives with `set`, and what the single command gives on
/// `scene`.
fn both(at: &Path, kind: &Value, set: &Value, scene: &str) -> [Vec<f32>; 2] {
    std::fs::write(at.join("other.xml"), scene).unwrap();
    let job = |id: &str, scene: &str| {
        let mut job = kind.clone();
        job["id"] = json!(id);
        job["scene"] = json!(scene);
        job
    };
    let (mut here, there) = (job("here", "s.xml"), job("there", "other.xml"));
    here["set"] = set.clone();
    write(at, "jobs.jsonl", &[here, there]);
    run(at, "batch jobs.jsonl -o out -q", 0);
    let found = ["here", "there"].map(|id| {
        let array = warpath::output::npy::read(&at.join("out").join(id).join("gradient.npy"));
        array.unwrap().values
    });
    std::fs::remove_dir_all(at.join("out")).unwrap();
    found
}

fn largest_difference([a, b]: &[Vec<f32>; 2]) -> f32 {
    let largest = |v: &[f32]| v.iter().fold(0.0f32, |m, x| m.max(x.abs()));
    let differences: Vec<f32> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    largest(&differences) / largest(b)
}

/// A job that is sensitive to everything.
fn turning() -> Value {
    json!({
        "mode": "forward", "params": {"card.translation": [1, 0.5, 0], "cam.rotation": [0, 0.1, 0]}, "spp": 16,
        "resolution": [24, 20], "method": "reparam"
    })
}

#[test]
fn one_sample_tells_no_standard_error_and_the_result_says_so() {
    let directory = workplace();
    let at = directory.path();
    let forward = |id: &str, spp: u32, rest: Value| {
        let mut job = json!({"id": id, "mode": "forward", "scene": "s.xml", "spp": spp,
            "params": {"card.translation": [1, 0, 0]}, "method": "reparam"});
        job.as_object_mut()
            .unwrap()
            .extend(rest.as_object().unwrap().clone());
        job
    };
    let jobs = [
        forward("asked", 1, json!({"outputs": ["stderr.npy"]})),
        forward("all", 1, json!({})),
        forward("without", 1, json!({"stderr": false})),
        forward("other", 1, json!({"outputs": ["gradient.npy"]})),
        forward("two", 2, json!({"outputs": ["stderr.npy"]})),
    ];
    write(at, "jobs.jsonl", &jobs);
    let out = run(at, "batch jobs.jsonl -o out -t 1", 0);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(
        message.matches("tells no standard error").count(),
        1,
        "{message}"
    );
    for (id, warns) in [
        ("asked", true),
        ("all", true),
        ("without", false),
        ("other", false),
        ("two", false),
    ] {
        let line = result(&at.join("out"), id);
        assert_eq!(line["warnings"].is_array(), warns, "{line}");
        assert_eq!(
            at.join("out").join(id).join("stderr.npy").exists(),
            id == "two"
        );
    }
}

#[test]
fn values_do_what_the_scene_file_would() {
    let directory = workplace();
    let at = directory.path();
    let kind = turning();
    let card = "<translate x=\"0.2\" y=\"0.1\" z=\"0.8\"/>";
    let moved = SCENE.replace(card, "<translate x=\"0.3\" y=\"0.1\" z=\"0.7\"/>");
    // Rounding differs where the loader rotates, scales and moves in one.
    let pairs = both(
        at,
        &kind,
        &json!({"card.translation": [0.1, 0, -0.1]}),
        &moved,
    );
    assert!(
        largest_difference(&pairs) < 1e-3,
        "{}",
        largest_difference(&pairs)
    );

    let coloured = SCENE.replace("0.2, 0.5, 0.1", "0.25, 0.75, 0.5");
    let set = json!({"floor.bsdf.reflectance.value": [0.25, 0.75, 0.5]});
    let pairs = both(at, &kind, &set, &coloured);
    assert_eq!(pairs[0], pairs[1]);

    let wide = SCENE.replace("\"fov\" value=\"40\"", "\"fov\" value=\"50\"");
    let pairs = both(at, &kind, &json!({"cam.x_fov": 50}), &wide);
    assert_eq!(pairs[0], pairs[1]);
    let bright = SCENE.replace("1, 1, 1", "2, 3, 1");
    let pairs = both(
        at,
        &kind,
        &json!({"env.radiance.value": [2, 3, 1]}),
        &bright,
    );
    assert_eq!(pairs[0], pairs[1]);
}

#[test]
fn what_is_kept_of_roughnesses_indices_and_lights_is_made_anew() {
    let directory = workplace();
    let at = directory.path();
    let plastic = r#"<bsdf type="roughplastic"><rgb name="diffuse_reflectance" value="0.2, 0.5, 0.1"/>
        <float name="alpha" value="0.3"/></bsdf>"#;
    let lamp = r#"<shape type="rectangle" id="lamp"><transform name="to_world"><rotate x="1" angle="180"/>
        <translate z="3"/></transform><emitter type="area"><rgb name="radiance" value="0, 0, 0"/></emitter></shape>
        <shape type="rectangle" id="lamp2"><transform name="to_world"><rotate x="1" angle="180"/>
        <translate x="3" z="3"/></transform><emitter type="area"><rgb name="radiance" value="1, 1, 1"/></emitter></shape>"#;
    let diffuse = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.1"/></bsdf>"#;
    let scene = SCENE
        .replace(diffuse, plastic)
        .replace("</scene>", &format!("{lamp}</scene>"));
    assert_ne!(scene, SCENE);
    std::fs::write(at.join("s.xml"), &scene).unwrap();
    for (key, value, before, after) in [
        (
            "floor.bsdf.alpha.value",
            json!(0.2),
            "\"alpha\" value=\"0.3\"",
            "\"alpha\" value=\"0.2\"",
        ),
        (
            "lamp.emitter.radiance.value",
            json!([9, 8, 7]),
            "\"0, 0, 0\"/></emitter>",
            "\"9, 8, 7\"/></emitter>",
        ),
        (
            "floor.bsdf.diffuse_reflectance.value",
            json!([0.5, 0.25, 0.125]),
            "0.2, 0.5, 0.1",
            "0.5, 0.25, 0.125",
        ),
    ] {
        let other = scene.replace(before, after);
        assert_ne!(other, scene, "{key}");
        let pairs = both(at, &turning(), &json!({key: value}), &other);
        assert_eq!(pairs[0], pairs[1], "{key}");
    }
}

#[test]
fn the_same_vertices_are_the_same_scene_from_an_array_or_a_tensor() {
    let directory = workplace();
    let at = directory.path();
    let corners = [
        [-1.0f32, -1.0, 0.1],
        [1.0, -1.0, 0.1],
        [-1.0, 1.0, 0.2],
        [1.0, 1.0, 0.2],
    ];
    let bytes: Vec<u8> = corners
        .iter()
        .flatten()
        .flat_map(|v| v.to_le_bytes())
        .collect();
    npy(at, "corners.npy", "<f4", "(4, 3)", &bytes);
    let view =
        safetensors::tensor::TensorView::new(safetensors::Dtype::F32, vec![4, 3], &bytes).unwrap();
    let file = safetensors::serialize([("floor.vertex_positions", view)], None).unwrap();
    std::fs::write(at.join("corners.safetensors"), file).unwrap();
    let ways = [
        json!(corners),
        json!(corners.as_flattened()),
        json!("corners.npy"),
        json!("corners.safetensors"),
    ];
    let jobs: Vec<Value> = ways
        .iter()
        .enumerate()
        .map(|(i, way)| {
            let key = ["floor.vertex_positions", "floor.positions"][i % 2];
            json!({
                "id": format!("{i}"), "mode": "forward", "scene": "s.xml", "params": {"floor.translation": [0, 0, 1]},
                "set": {(key): way}
            })
        })
        .collect();
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o out -q", 0);
    let first = files(&at.join("out/0"));
    assert!((1..4).all(|i| files(&at.join(format!("out/{i}"))) == first));
}

/// Who asks by another name of a parameter is answered by that name.
#[test]
fn gradients_have_the_names_they_are_asked_for_by() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("s.xml"), SCENE).unwrap();
    let target = vec![0u8; 4 * 8 * 6 * 3];
    npy(at, "target.npy", "<f4", "(6, 8, 3)", &target);
    let job = json!({
        "id": "0", "mode": "backward", "scene": "s.xml", "params": ["floor.positions"],
        "target": "target.npy", "resolution": [8, 6], "outputs": ["gradients.npz"],
    });
    write(at, "jobs.jsonl", &[job]);
    run(at, "batch jobs.jsonl -o out -q", 0);
    let lines = std::fs::read_to_string(at.join("out/results.jsonl")).unwrap();
    let line: Value = serde_json::from_str(lines.lines().next().unwrap()).unwrap();
    assert!(line["norms"]["floor.positions"].is_number(), "{line}");
    let gradients = std::fs::read(at.join("out/0/gradients.npz")).unwrap();
    let name = b"floor.positions.npy";
    assert!(gradients.windows(name.len()).any(|w| w == name));
}

/// What a job's rays hit does not depend on the jobs whose structure it refits, nor on their
/// number.
#[test]
fn moved_vertices_give_the_same_bytes_in_any_order() {
    let directory = workplace();
    let at = directory.path();
    let ball = r#"<shape type="sphere" id="ball"><point name="center" x="0" y="0" z="0.4"/>
        <float name="radius" value="0.3"/><boolean name="face_normals" value="true"/></shape>"#;
    std::fs::write(
        at.join("s.xml"),
        SCENE.replace("</scene>", &format!("{ball}</scene>")),
    )
    .unwrap();
    let scene = warpath::scene::load(at.join("s.xml"), &[]).unwrap();
    let mesh = scene.meshes.iter().find(|m| m.id == "ball").unwrap();
    let mut jobs = Vec::new();
    for i in 0..12 {
        // From a little noise, which is refitted, to so much that the structure is built anew.
        let noise = 0.002 * f64::from(1 << i.min(9)) as f32;
        let values: Vec<u8> = mesh
            .positions
            .iter()
            .enumerate()
            .flat_map(|(v, p)| {
                let wave =
                    |k: usize| ((v * (k + 3) + i as usize * 7) as f32 * 12.9898).sin() * noise;
                [p.x + wave(0), p.y + wave(1), p.z + wave(2)]
            })
            .flat_map(f32::to_le_bytes)
            .collect();
        let shape = format!("({}, 3)", mesh.positions.len());
        npy(at, &format!("v{i}.npy"), "<f4", &shape, &values);
        jobs.push(json!({
            "id": format!("{i}"), "mode": "forward", "scene": "s.xml", "params": {"ball.translation": [1, 0, 0]},
            "set": {"ball.vertex_positions": format!("v{i}.npy")}, "spp": 8, "resolution": [40, 40]
        }));
    }
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o forwards -q -t 1", 0);
    jobs.reverse();
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o backwards -q -t 3", 0);
    crate::jobs::assert_same_files(&at.join("forwards"), &at.join("backwards"));
    let ways: Vec<bool> = results(&at.join("forwards"))
        .iter()
        .map(|r| r["rebuilt"].as_bool().unwrap())
        .collect();
    assert!(ways.contains(&true) && ways.contains(&false), "{ways:?}");
}

/// Jobs that ask the same with values of their own share one pilot, that of the scene without them.
#[test]
fn values_of_ones_own_need_no_pilot_of_ones_own() {
    let directory = workplace();
    let at = directory.path();
    let job = |id: &str, x: f64| {
        json!({
            "id": id, "mode": "forward", "scene": "s.xml", "params": {"card.translation": [1, 0, 0]},
            "set": {"card.translation": [x, 0, 0]}, "spp": 8, "resolution": [16, 12]
        })
    };
    write(at, "jobs.jsonl", &[job("one", 0.1), job("other", 0.2)]);
    run(at, "batch jobs.jsonl -o out -q -t 1", 0);
    let seconds: Vec<f64> = results(&at.join("out"))
        .iter()
        .map(|result| result["seconds"]["pilot"].as_f64().expect("a pilot's time"))
        .collect();
    let asked = seconds.iter().filter(|&&seconds| seconds > 0.0);
    assert_eq!(asked.count(), 1, "{seconds:?}");
}
