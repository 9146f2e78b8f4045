//! What a study finds: a method that is right, and one that is not.

use super::write_config;
use crate::workplace::{text, typed, warpath, workplace};
use serde_json::{Value, json};
use std::path::Path;
use warpath::methods::ESTIMATORS;

fn study(directory: &Path, line: &str) -> (Option<i32>, String) {
    let out = warpath(directory, &typed(line));
    let message = text(&out.stderr);
    assert!(!message.contains("panicked"), "{message}");
    (out.status.code(), message)
}

fn results(directory: &Path, folder: &str) -> Value {
    let text = std::fs::read_to_string(directory.join(folder).join("study.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The cell of a direction (0: the card moves, 1: the floor grows brighter).
fn cell<'a>(results: &'a Value, direction: &str, method: &str, spp: u64) -> &'a Value {
    let rows = results["rows"].as_array().unwrap();
    let row = rows
        .iter()
        .find(|row| row["direction"] == direction)
        .unwrap();
    let cells = row["cells"].as_array().unwrap();
    let is_it = |c: &&Value| c["method"] == method && c["spp"] == spp;
    cells.iter().find(is_it).unwrap()
}

fn check_report(at: &Path) {
    let report = std::fs::read(at.join("out/report.json")).unwrap();
    let report: Value = serde_json::from_slice(&report).unwrap();
    let scene = &report["scenes"][0];
    assert_eq!(
        (&report["seed"], &scene["name"], &scene["path"]),
        (&json!(3), &json!("card"), &json!("s.xml"))
    );
    let hash = scene["hash"].as_str().unwrap();
    assert!(hash.starts_with("fnv1a64:"), "{hash}");
    for stage in ["load", "measure", "write", "total"] {
        assert!(report["seconds"][stage].as_f64().is_some(), "{stage}");
    }
    let files = report["files"].as_array().unwrap();
    for name in files.iter().map(|name| name.as_str().unwrap()) {
        let there = at.join("out").join(name).exists() || at.join(name).exists();
        assert!(there, "{name}");
    }
    for name in ["study.jsonl", "gradients/", "references/", "r.md"] {
        assert!(files.contains(&json!(name)), "{name}");
    }
}

#[test]
fn interior_is_found_biased_and_reparam_right() {
    let directory = workplace();
    let at = directory.path();
    write_config(at);
    std::fs::write(
        at.join("b.toml"),
        "[[bound]]\nmethod = \"reparam\"\nspp = 16\nverdict = [\"right\"]\nat_least = { coverage = 0.7 }\n\
         at_most = { bias_sigmas = 4, rejected_share = 1e-6, not_finite = 0 }\n\
         [[bound]]\ndirection = \"shift\"\nmethod = \"interior\"\nverdict = [\"biased\"]\n",
    )
    .unwrap();
    // The pictures of the shift have kinks in single pixels under a box; more runs for the signs.
    let line = "study c.toml -o out --assert b.toml --report r.md --set repeats=24 \
                --set reference.runs=24 --set reference.spp=256";
    let (code, message) = study(at, line);
    assert_eq!(code, Some(0), "{message}");
    let all = results(at, "out");
    let figure = |direction, method, spp, name: &str| {
        let value = &cell(&all, direction, method, spp)["figures"][name];
        value
            .as_f64()
            .unwrap_or_else(|| panic!("{method} {name}: {value}"))
    };
    // The noise of both is what four times the samples leave: half.
    for method in ["reparam", "fd"] {
        let ratio = figure("shift", method, 16, "sd") / figure("shift", method, 4, "sd");
        assert!((0.3..0.8).contains(&ratio), "{method}: {ratio}");
    }
    let [bias, se] = ["size_bias", "size_bias_se"].map(|n| figure("shift", "interior", 16, n));
    assert!(bias < -4.0 * se && bias < -0.1, "{bias} {se}");
    assert!(figure("shift", "interior", 16, "coverage") < 0.9);
    // The same sum in two ways: the error of a run is its bias and its noise.
    for method in ["reparam", "interior", "fd"] {
        let [error, sd] = ["rmse", "sd"].map(|n| figure("shift", method, 16, n));
        let bias = figure("shift", method, 16, "bias_squared");
        let se = figure("shift", method, 16, "bias_squared_se");
        let apart = (error * error - sd * sd - bias).abs();
        assert!(
            apart <= 4.0 * se + 0.02 * error * error,
            "{method}: {apart} {se}"
        );
    }
    for name in [
        "study.csv",
        "study.html",
        "summary.svg",
        "summary.png",
        "card-shift.svg",
        "card-shift.png",
        "card-shift-gradients.png",
        "report.json",
    ] {
        assert!(at.join("out").join(name).exists(), "{name}");
    }
    check_report(at);
    let lines = std::fs::read_to_string(at.join("out/study.csv")).unwrap();
    let columns: Vec<usize> = lines.lines().map(|line| line.split(',').count()).collect();
    assert!(
        columns.len() == 1 + 2 * 2 * ESTIMATORS.len() && columns.iter().all(|n| *n == columns[0])
    );
    let page = std::fs::read_to_string(at.join("out/study.html")).unwrap();
    assert!(
        !page.contains("http://")
            || page.matches("http").count() == page.matches("http://www.w3.org").count()
    );
    let table = std::fs::read_to_string(at.join("r.md")).unwrap();
    assert!(
        table.contains("**biased**") && !table.contains("NaN"),
        "{table}"
    );
    for line in table.lines().filter(|line| line.starts_with('|')) {
        assert!(!line.contains("|  |"), "a blank cell: {line}");
    }
}

#[test]
fn bounds_that_do_not_hold_end_with_1() {
    let directory = workplace();
    let at = directory.path();
    write_config(at);
    let few = "--set repeats=3 --set reference.runs=3 --set reference.spp=8 --set spp=[4]";
    let bounds = [
        (
            "[[bound]]\nat_most = { rays = 1 }\n",
            1,
            "card shift, reparam with 4 samples: rays is",
        ),
        (
            "[[bound]]\nat_least = { rmse = 1e9 }\n",
            1,
            "below 1000000000",
        ),
        ("[[bound]]\nverdict = [\"refused\"]\n", 1, "not refused"),
        (
            "[[bound]]\nmethod = \"reparam\"\nat_least = { rays = 1 }\n",
            0,
            "",
        ),
        (
            "[[bound]]\nspp = 5\nat_least = { rays = 1 }\n",
            3,
            "b.toml:1:1: the study has nothing of this",
        ),
    ];
    for (number, (text, code, said)) in bounds.into_iter().enumerate() {
        std::fs::write(at.join("b.toml"), text).unwrap();
        let resume = if number > 0 { "--resume" } else { "" };
        let line = format!("study c.toml -o out --assert b.toml {few} {resume}");
        let (ended, message) = study(at, &line);
        assert_eq!(ended, Some(code), "{text}: {message}");
        assert!(message.contains(said), "{text}: {message}");
    }
}

#[test]
fn other_programs_stand_in_the_charts_with_where_they_ran() {
    let directory = workplace();
    let at = directory.path();
    let peers = r#"[{"scene":"card","integrator":"prb & co","spp":16,"rfilter":"box","cpu":0.5,"rel_rmse":0.3},
        {"scene":"card","integrator":"tented","spp":16,"rfilter":"tent","cpu":0.5,"rel_rmse":0.3},
        {"scene":"card","integrator":"untimed","spp":16,"rel_rmse":NaN}, {"scene":"other","integrator":"else","spp":1,"cpu":1,"rel_rmse":1}]"#;
    std::fs::write(at.join("p.json"), peers).unwrap();
    let few = "repeats = 2\nspp = [4]\npeers = { file = \"p.json\", label = \"Other 1.0, on another machine\" }\n";
    let config = super::CONFIG.replace("spp = [4, 16]\nrepeats = 12\n", few);
    std::fs::write(at.join("c.toml"), config.replace("runs = 12", "runs = 2")).unwrap();
    let (code, message) = study(at, "study c.toml -o out");
    assert_eq!(code, Some(0), "{message}");
    let chart = std::fs::read_to_string(at.join("out/card-shift.svg")).unwrap();
    for word in ["prb &amp; co", "diamonds: Other 1.0, on another machine"] {
        assert!(chart.contains(word), "{word}");
    }
    for word in ["tented", "untimed", "else"] {
        assert!(!chart.contains(word), "{word}");
    }
    std::fs::write(at.join("p.json"), r#"[{"cpu": 1, "rel_rmse": 2}]"#).unwrap();
    let (code, message) = study(at, "study c.toml -o out2");
    assert!(code == Some(3) && message.contains("p.json:"), "{message}");
}

#[test]
fn a_scene_may_have_a_reference_of_its_own() {
    let directory = workplace();
    let at = directory.path();
    let few = super::CONFIG.replace("spp = [4, 16]\nrepeats = 12\n", "spp = [4]\nrepeats = 2\n");
    let few = few.replace("runs = 12", "runs = 2");
    let (_, scene) = few.split_once("[[scene]]").unwrap();
    let other = scene.replace("\"card\"\n", "\"other\"\n").replacen(
        "[scene.direction",
        "[scene.reference]\nspp = 8\n[scene.direction",
        1,
    );
    std::fs::write(at.join("c.toml"), format!("{few}[[scene]]{other}")).unwrap();
    let (code, message) = study(at, "study c.toml -o out --report r.md");
    assert_eq!(code, Some(0), "{message}");
    let all = results(at, "out");
    let spp =
        |row: &Value| [&row["reference"]["runs"], &row["reference"]["spp"]].map(Value::as_u64);
    let found: Vec<_> = all["rows"].as_array().unwrap().iter().map(spp).collect();
    assert_eq!(found, [64, 64, 8, 8].map(|spp| [2, spp].map(Some)));
    let report = std::fs::read_to_string(at.join("r.md")).unwrap();
    assert!(report.contains(" × 8 samples: "), "{report}");
}

/// What a battery must never show, whatever the method: numbers that are none, and blank cells.
const SANE: &str = "[[bound]]\nat_most = { not_finite = 0, rejected_share = 1e-2 }\n";

/// A part of the failure battery that takes seconds, with few samples: what is right must not be
/// found biased, what must be zero is, what cannot be done is refused, and `interior` is caught.
#[test]
fn a_part_of_the_failure_battery() {
    let directory = workplace();
    let at = directory.path();
    let config = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/failures/study.toml");
    std::fs::write(
        at.join("b.toml"),
        "[[bound]]\nmethod = \"reparam\"\nscene = \"sphere\"\nverdict = [\"right\"]\n\
         [[bound]]\nmethod = \"interior\"\nscene = \"sphere\"\nverdict = [\"biased\"]\n\
         [[bound]]\nmethod = \"reparam\"\nscene = \"light_middle\"\nverdict = [\"right\", \"unknown\"]\n\
         [[bound]]\nmethod = \"reparam\"\nscene = \"unseen\"\nat_most = { rmse = 0, bias_squared = 0 }\nverdict = [\"right\"]\n\
         [[bound]]\nmethod = \"reparam\"\nscene = \"point_light\"\nverdict = [\"right\"]\n         [[bound]]\nmethod = \"edges\"\nscene = \"point_light\"\nverdict = [\"refused\"]\n",
    )
    .unwrap();
    let line = format!(
        "study {config} -o out --only sphere,light_middle,unseen,point_light --assert b.toml \
         --report r.md --set resolution=12x12 --set spp=[16] --set repeats=20 \
         --set reference.runs=20 --set reference.spp=64"
    );
    let (code, message) = study(at, &line);
    assert_eq!(code, Some(0), "{message}");
    std::fs::write(
        at.join("b.toml"),
        SANE.replace("[[bound]]", "[[bound]]\nscene = \"sphere\""),
    )
    .unwrap();
    let (code, message) = study(at, &(line + " --resume"));
    assert_eq!(code, Some(0), "{message}");
}

/// All of it.
#[cfg(feature = "long-tests")]
#[test]
fn the_failure_battery() {
    let directory = workplace();
    let at = directory.path();
    let config = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/failures/study.toml");
    let (code, message) = study(at, &format!("study {config} -o out --report r.md"));
    assert_eq!(code, Some(0), "{message}");
    let all = results(at, "out");
    for row in all["rows"].as_array().unwrap() {
        for cell in row["cells"].as_array().unwrap() {
            let name = format!("{} {}", row["scene"], cell["method"]);
            if cell["verdict"]["kind"] != "refused" {
                assert_eq!(cell["figures"]["not_finite"], 0, "{name}");
            }
            assert_ne!(cell["verdict"]["text"], "", "{name}");
        }
    }
}
