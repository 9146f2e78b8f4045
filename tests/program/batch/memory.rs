//! Memory is admitted, not hoped for.

use crate::jobs::{result, results, run, write};
use crate::workplace::{SCENE, npy, workplace};
use serde_json::json;

#[test]
fn a_job_that_cannot_fit_fails_and_the_others_run() {
    let directory = workplace();
    let at = directory.path();
    let job = |id: &str, side: u32| json!({"id": id, "mode": "render", "scene": "s.xml", "resolution": [side, side]});
    write(
        at,
        "jobs.jsonl",
        &[job("a", 8), job("huge", 6000), job("b", 9)],
    );
    run(at, "batch jobs.jsonl -o out -t 1 --memory 200M", 5);
    let failed = result(&at.join("out"), "huge");
    assert_eq!(failed["code"], 4);
    let message = failed["message"].as_str().unwrap();
    assert!(
        message.contains("the job needs about") && message.contains("--memory 200 MB"),
        "{message}"
    );
    for id in ["a", "b"] {
        assert_eq!(result(&at.join("out"), id)["status"], "ok");
    }
}

#[test]
fn a_mesh_or_picture_that_cannot_fit_is_not_even_read() {
    let directory = workplace();
    let at = directory.path();
    // A mesh file of 400 MB without a block on the disk, and a small file that says it is a large
    // picture.
    std::fs::File::create(at.join("large.ply"))
        .unwrap()
        .set_len(400 << 20)
        .unwrap();
    let mut picture = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR".to_vec();
    picture.extend([0, 0, 0x40, 0, 0, 0, 0x40, 0, 8, 0, 0, 0, 0]);
    picture.extend(crc(&picture[12..]).to_be_bytes());
    picture.extend(b"\0\0\x04\0IDAT");
    picture.extend([0; 6000]);
    std::fs::write(at.join("large.png"), picture).unwrap();
    let mesh = r#"<shape type="ply"><string name="filename" value="large.ply"/></shape>"#;
    let textured = r#"<shape type="rectangle"><bsdf type="diffuse"><texture name="reflectance" type="bitmap">
        <string name="filename" value="large.png"/></texture></bsdf></shape>"#;
    for (name, shape) in [("mesh.xml", mesh), ("picture.xml", textured)] {
        let scene = SCENE.replace("</scene>", &format!("{shape}</scene>"));
        std::fs::write(at.join(name), scene).unwrap();
    }
    let job = |id: &str, scene: &str| json!({"id": id, "mode": "render", "scene": scene});
    let jobs = [
        job("mesh", "mesh.xml"),
        job("picture", "picture.xml"),
        job("good", "s.xml"),
    ];
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o out --memory 300M -t 1", 5);
    for (id, file) in [("mesh", "large.ply"), ("picture", "large.png")] {
        let failed = result(&at.join("out"), id);
        let message = failed["message"].as_str().unwrap();
        assert_eq!(failed["code"], 4, "{message}");
        assert!(
            message.contains(file) && message.contains("--memory 300 MB"),
            "{message}"
        );
    }
    assert_eq!(result(&at.join("out"), "good")["status"], "ok");
}

/// Of a PNG chunk.
fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            (c >> 1) ^ (0xedb8_8320 & (c & 1).wrapping_neg())
        })
    };
    !bytes.iter().fold(!0, step)
}

#[test]
fn files_that_a_job_names_are_counted_before_they_are_read() {
    let directory = workplace();
    let at = directory.path();
    // As long as their headers say, without a block on the disk.
    let sparse = |name: &str, bytes: u64| {
        let file = std::fs::File::options().append(true).open(at.join(name));
        let file = file.unwrap();
        let header = file.metadata().unwrap().len();
        file.set_len(header + bytes).unwrap();
    };
    npy(at, "target.npy", "<f4", "(1500, 2000, 3)", &[]);
    sparse("target.npy", 36_000_000);
    std::fs::write(at.join("target.pfm"), "PF\n2000 1500\n-1.0\n").unwrap();
    sparse("target.pfm", 36_000_000);
    npy(at, "long.npy", "<f4", "(150000000,)", &[]);
    sparse("long.npy", 600_000_000);
    let job = |id: &str, target: &str| {
        json!({"id": id, "mode": "backward", "scene": "s.xml", "params": ["floor.scale"], "resolution": [2000, 1500],
               "target": target})
    };
    let mut long = job("long", "small.npy");
    long["resolution"] = json!([4, 4]);
    long["set"] = json!({"floor.scale": "long.npy"});
    write(
        at,
        "jobs.jsonl",
        &[
            job("array", "target.npy"),
            job("picture", "target.pfm"),
            long,
        ],
    );
    run(at, "batch jobs.jsonl -o out -t 1 --memory 200M", 5);
    let megabytes = |id: &str| -> f64 {
        let failed = result(&at.join("out"), id);
        assert_eq!(failed["code"], 4, "{failed}");
        let message = failed["message"].as_str().unwrap();
        let (_, rest) = message.split_once("the job needs about ").unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    // A picture's file is in memory beside its pixels, an array's is not.
    let more = megabytes("picture") - megabytes("array");
    assert!((30.0..40.0).contains(&more), "{more} MB");
    let failed = result(&at.join("out"), "long");
    let message = failed["message"].as_str().unwrap();
    assert_eq!(failed["code"], 3, "{message}");
    assert!(
        message.contains("long.npy: the shape is (150000000,), floor.scale has (1,)"),
        "{message}"
    );
    let report = std::fs::read(at.join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    let peak = report["summary"]["peak_memory_bytes"].as_u64().unwrap();
    assert!(peak < 200 << 20, "{} MB", peak >> 20);
}

#[test]
fn scenes_make_room_for_one_another() {
    let directory = workplace();
    let at = directory.path();
    // Each takes about 40 MB; the limit holds two beside the program.
    let ball = r#"<shape type="sphere"><point name="center" x="0" y="0" z="$z"/><float name="radius" value="0.2"/>
        <bsdf type="diffuse"><texture name="reflectance" type="bitmap"><string name="filename" value="sky.pfm"/>
        </texture></bsdf></shape>"#;
    let mut picture = b"PF\n1000 1000\n-1.0\n".to_vec();
    picture.extend(0.5f32.to_le_bytes().repeat(3_000_000));
    std::fs::write(at.join("sky.pfm"), picture).unwrap();
    let scene = SCENE.replace(
        "</scene>",
        &format!("<default name=\"z\" value=\"0\"/>{ball}</scene>"),
    );
    std::fs::write(at.join("ball.xml"), scene).unwrap();
    let jobs: Vec<_> = (0..12)
        .map(|i| {
            json!({"id": format!("{i}"), "mode": "render", "scene": "ball.xml", "defines": {"z": i % 6}})
        })
        .collect();
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o out --memory 250M -t 2", 0);
    assert_eq!(results(&at.join("out")).len(), 12);
    let report = std::fs::read(at.join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(
        report["summary"]["scene_loads"], 6,
        "jobs of one scene stand together"
    );
    let peak = report["summary"]["peak_memory_bytes"].as_u64().unwrap();
    assert!(peak < 250 << 20, "{} MB", peak >> 20);
}
