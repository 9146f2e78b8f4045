//! Whole runs: their files, which do not depend on threads, and what the report says.

use crate::workplace::{text, typed, warpath, workplace};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// A command, and the files it is to write besides the report.
const RUNS: [(&str, &[&str]); 3] = [
    (
        "render s.xml --spp 16 --resolution 40x30",
        &["image.exr", "image.png"],
    ),
    (
        "forward s.xml --spp 16 --resolution 40x30 --param card.translation=1,0,0 --param cam.x_fov=2",
        &[
            "gradient.exr",
            "gradient.npy",
            "gradient.png",
            "image.exr",
            "stderr.npy",
        ],
    ),
    (
        "backward s.xml --spp 16 --param card.vertex_positions --param floor.bsdf.reflectance.value --target target.npy",
        &["gradients.npz", "gradients.safetensors", "image.exr"],
    ),
];

fn run(directory: &Path, line: &str) -> BTreeMap<String, Vec<u8>> {
    let out = warpath(directory, &typed(&format!("{line} -o out")));
    assert_eq!(out.status.code(), Some(0), "{line}: {}", text(&out.stderr));
    assert!(out.stdout.is_empty(), "{line}: {}", text(&out.stdout));
    let files = std::fs::read_dir(directory.join("out")).unwrap();
    let files = files.map(|file| {
        let path = file.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_string();
        (name, std::fs::read(path).unwrap())
    });
    let files = files.collect();
    std::fs::remove_dir_all(directory.join("out")).unwrap();
    files
}

/// The report without what may differ from run to run.
fn report(files: &mut BTreeMap<String, Vec<u8>>) -> Value {
    let bytes = files.remove("report.json").expect("a report");
    let mut report: Value = serde_json::from_slice(&bytes).unwrap();
    for key in ["seconds", "threads", "peak_memory_bytes", "arguments"] {
        assert!(
            report.as_object_mut().unwrap().remove(key).is_some(),
            "{key}"
        );
    }
    report
}

#[test]
fn files_are_the_same_for_all_threads_and_every_time() {
    let directory = workplace();
    for (line, names) in RUNS {
        let mut first = run(directory.path(), &format!("{line} -t 1"));
        let first_report = report(&mut first);
        let found: Vec<&str> = first.keys().map(String::as_str).collect();
        assert_eq!(found, names, "{line}");
        for again in ["-t 1", "-t 2", "-t 3"] {
            let mut second = run(directory.path(), &format!("{line} {again}"));
            let second_report = report(&mut second);
            assert_eq!(first_report, second_report, "{line} {again}");
            for (name, bytes) in &first {
                assert!(bytes == &second[name], "{line} {again}: {name} differs");
            }
        }
        let mut other = run(directory.path(), &format!("{line} --seed 99"));
        report(&mut other);
        assert!(
            other["image.exr"] != first["image.exr"],
            "{line}: the seed does nothing"
        );
    }
}

#[test]
fn the_report_tells_what_was_done() {
    let directory = workplace();
    for (line, _) in RUNS {
        let files = run(directory.path(), line);
        let report: Value = serde_json::from_slice(&files["report.json"]).unwrap();
        let names: Vec<&str> = report["files"]
            .as_array()
            .unwrap()
            .iter()
            .filter_map(Value::as_str)
            .collect();
        assert!(
            names.len() == files.len() && names.iter().all(|name| files.contains_key(*name)),
            "{names:?}"
        );
        let seconds = |stage: &str| report["seconds"][stage].as_f64();
        for stage in ["load", "build", "primal", "write", "total"] {
            assert!(seconds(stage).is_some_and(|s| s >= 0.0), "{line}: {stage}");
        }
        assert_eq!(
            seconds("adjoint").is_some(),
            !line.starts_with("render"),
            "{line}"
        );
        assert!(report["rays"]["camera"].as_u64().unwrap() > 0);
        assert_eq!(
            report["spp"],
            if line.contains("--spp 16") { 16 } else { 4 }
        );
        assert!(
            report["scene"]["hash"]
                .as_str()
                .unwrap()
                .starts_with("fnv1a64:")
        );
        assert!(
            report["peak_memory_bytes"]
                .as_u64()
                .is_none_or(|bytes| bytes > 1_000_000)
        );
    }
}

/// One sample a pixel is one group, which has no spread: whoever wants standard errors hears of it.
#[test]
fn standard_errors_that_cannot_be_told_are_warned_about() {
    let directory = workplace();
    let warning = "with one sample a pixel there are no standard errors: raise --spp";
    let backward = "backward s.xml --param floor.translation --target target.npy";
    for line in ["forward s.xml --param floor.translation=1,0,0", backward] {
        for (rest, is_warned) in [
            ("--spp 1", true),
            ("--spp 2", false),
            ("--spp 1 --no-stderr", false),
        ] {
            let line = format!("{line} {rest} -o out");
            let out = warpath(directory.path(), &typed(&line));
            let message = text(&out.stderr);
            assert_eq!(out.status.code(), Some(0), "{line}: {message}");
            assert_eq!(message.contains(warning), is_warned, "{line}: {message}");
            let report = std::fs::read(directory.path().join("out/report.json")).unwrap();
            let report: Value = serde_json::from_slice(&report).unwrap();
            let is_told = report["warnings"].to_string().contains(warning);
            assert_eq!(is_told, is_warned, "{line}: {report}");
            std::fs::remove_dir_all(directory.path().join("out")).unwrap();
        }
    }
}

/// Both modes use the same samples: their results are the same number.
#[test]
fn backward_is_the_transpose_of_forward() {
    let directory = workplace();
    let common = "--spp 16 --seed 5 s.xml";
    let direction = [0.4f32, -0.3, 0.7];
    let forward = run(
        directory.path(),
        &format!("forward {common} --param card.translation=0.4,-0.3,0.7"),
    );
    let gradient = warpath::output::npy::decode(&forward["gradient.npy"]).unwrap();
    // The adjoint image is 0.5 everywhere.
    let forward: f64 = gradient.values.iter().map(|v| f64::from(*v) * 0.5).sum();
    let line = format!(
        "backward {common} --param card.translation --param card.positions --adjoint target.npy"
    );
    let backward = run(directory.path(), &line);
    let tensors =
        safetensors::SafeTensors::deserialize(&backward["gradients.safetensors"]).unwrap();
    let numbers = |name: &str| -> Vec<f64> {
        let tensor = tensors.tensor(name).unwrap();
        let parts = tensor.data().as_chunks::<4>().0;
        parts
            .iter()
            .map(|b| f64::from(f32::from_le_bytes(*b)))
            .collect()
    };
    let of_translation = numbers("card.translation");
    let product: f64 = of_translation
        .iter()
        .zip(direction)
        .map(|(g, d)| g * f64::from(d))
        .sum();
    let size = gradient
        .values
        .iter()
        .map(|v| f64::from(v.abs()) * 0.5)
        .sum::<f64>();
    assert!(
        (forward - product).abs() < 1e-4 * size,
        "{forward} {product} {size}"
    );
    let of_positions = numbers("card.positions");
    for axis in 0..3 {
        let sum: f64 = of_positions.iter().skip(axis).step_by(3).sum();
        assert!(
            (sum - of_translation[axis]).abs() < 1e-4 * size,
            "{sum} {of_translation:?}"
        );
    }
    assert_eq!(numbers("card.translation#se").len(), 3);
    assert!(numbers("card.positions#se").iter().any(|e| *e > 0.0));
    let without = run(directory.path(), &format!("{line} --no-stderr"));
    let tensors = safetensors::SafeTensors::deserialize(&without["gradients.safetensors"]).unwrap();
    assert_eq!(tensors.names().len(), 2);
}

#[test]
fn json_puts_the_report_on_stdout() {
    let directory = workplace();
    let out = warpath(directory.path(), &typed("render s.xml --json -q -o out"));
    assert!(out.stderr.is_empty(), "{}", text(&out.stderr));
    let written = std::fs::read(directory.path().join("out/report.json")).unwrap();
    assert_eq!(out.stdout, written);
}

/// `auto` says what its pilot tried, in the report and, if asked, on stderr.
#[test]
fn auto_explains_itself() {
    let directory = workplace();
    let line = "forward s.xml --param card.translation=1,0,0 --method auto --explain -o out";
    let out = warpath(directory.path(), &typed(line));
    let message = text(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{message}");
    let report = std::fs::read(directory.path().join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
    assert_eq!(report["method"], "auto");
    let trials = report["pilot"]["trials"].as_array().unwrap();
    assert!(trials.len() > 1, "{report}");
    for trial in trials {
        let way = trial["way"].as_str().unwrap();
        assert!(message.contains(&format!("auto tried {way}:")), "{message}");
    }
    let chosen = report["pilot"]["chosen"].as_str().unwrap();
    assert!(trials.iter().any(|trial| trial["way"] == chosen));
    assert!(message.contains(&format!("auto: {chosen}")), "{message}");
}
