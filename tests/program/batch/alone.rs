//! A job gives the bytes of the command that does the same.

use crate::jobs::{assert_same_files, result, run, write};
use crate::workplace::workplace;
use serde_json::{Value, json};

/// Names, the command, and the job without what all share.
fn cases() -> [(&'static str, String, Value); 7] {
    [
        ("render", "render s.xml".to_string(), json!({"mode": "render"})),
        (
            "forward",
            "forward s.xml --param cam.x_fov=2 --param card.translation=1,0,0.5".into(),
            json!({"mode": "forward", "params": {"cam.x_fov": 2, "card.translation": [1, 0, 0.5]}}),
        ),
        (
            "interior",
            "forward s.xml --param card.scale=1 --method interior --no-stderr".into(),
            json!({"mode": "forward", "params": {"card.scale": 1}, "method": "interior", "stderr": false}),
        ),
        (
            "fd",
            "forward s.xml --param card.translation=0,1,0 --method fd".into(),
            json!({"mode": "forward", "params": {"card.translation": [0, 1, 0]}, "method": "fd"}),
        ),
        (
            "target",
            "backward s.xml --param card.vertex_positions --param env.radiance.value --target wide.npy --loss l1".into(),
            json!({
                "mode": "backward", "params": ["card.vertex_positions", "env.radiance.value"], "target": "wide.npy",
                "loss": "l1"
            }),
        ),
        (
            "adjoint",
            "backward s.xml --param card.rotation --adjoint wide.npy".into(),
            json!({"mode": "backward", "params": ["card.rotation"], "adjoint": "wide.npy"}),
        ),
        (
            "second",
            "backward s.xml --sensor 1 --param second.rotation --adjoint wide.npy".into(),
            json!({"mode": "backward", "params": ["second.rotation"], "adjoint": "wide.npy", "sensor": 1, "resolution": "40x30"}),
        ),
    ]
}

/// What the batch says of a job is what the report of the single command says.
fn assert_same_words(said: &Value, report: &Value, id: &str) {
    assert_eq!(said["rays"], report["rays"], "{id}");
    assert_eq!(said["scene_hash"], report["scene"]["hash"], "{id}");
    assert_eq!(said["loss"], report["results"]["loss"], "{id}");
    if let Some(norms) = report["results"].get("norms") {
        assert_eq!(said["norms"], *norms, "{id}");
    }
}

#[test]
fn a_job_gives_the_bytes_of_the_single_command() {
    let directory = workplace();
    let at = directory.path();
    let common = "--spp 16 --seed 7 --resolution 40x30 --max-depth 3 -D filter=gaussian";
    crate::workplace::npy(
        at,
        "wide.npy",
        "<f4",
        "(30, 40, 3)",
        &crate::workplace::floats(3600, 0.4),
    );
    let shared = json!({
        "scene": "s.xml", "spp": 16, "seed": 7, "resolution": [40, 30], "max_depth": 3,
        "defines": {"filter": "gaussian"}
    });
    let cases = cases();
    let jobs: Vec<_> = cases
        .iter()
        .map(|(id, _, job)| {
            let mut whole = shared.clone();
            whole["id"] = json!(id);
            for (field, value) in job.as_object().unwrap() {
                whole[field] = value.clone();
            }
            whole
        })
        .collect();
    write(at, "jobs.jsonl", &jobs);
    for (threads, backend) in [(1, ""), (3, ""), (2, "--backend obvhs:slow")] {
        if !backend.is_empty() && !cfg!(feature = "obvhs") {
            continue;
        }
        let output = format!("batch-{threads}");
        let line = format!("batch jobs.jsonl -o {output} -t {threads} {backend}");
        run(at, &line, 0);
        for (id, line, _) in &cases {
            let line = format!("{line} {common} {backend} -o single -t 2 -q");
            run(at, &line, 0);
            assert_same_files(&at.join("single"), &at.join(&output).join(id));
            let report = std::fs::read(at.join("single/report.json")).unwrap();
            let report: Value = serde_json::from_slice(&report).unwrap();
            assert_same_words(&result(&at.join(&output), id), &report, id);
            std::fs::remove_dir_all(at.join("single")).unwrap();
        }
        let report = std::fs::read(at.join(&output).join("report.json")).unwrap();
        let report: Value = serde_json::from_slice(&report).unwrap();
        assert_eq!(report["summary"]["jobs"], cases.len());
        assert_eq!(
            report["summary"]["scene_loads"], 1,
            "one scene, loaded once"
        );
    }
}
