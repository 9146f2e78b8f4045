//! Small optimisations arrive at the known truth.

use super::{CONFIG, optimize};
use crate::workplace::workplace;
use std::path::Path;

fn errors(at: &Path) -> Vec<(f64, f64)> {
    let report = std::fs::read_to_string(at.join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    let all = report["parameter_errors"].as_array().unwrap();
    let number = |e: &serde_json::Value, name: &str| e[name].as_f64().unwrap();
    all.iter()
        .map(|e| (number(e, "start"), number(e, "end")))
        .collect()
}

fn run(parameters: &str, steps: &str) -> Vec<(f64, f64)> {
    let directory = workplace();
    let at = directory.path();
    let (head, _) = CONFIG.split_once("[parameters").unwrap();
    let head = head
        .replace("steps = 6", steps)
        .replace("spp = 64", "spp = 4096");
    let head = head.replace("lr = 0.02", "lr = { start = 0.03, end = 0.001 }");
    std::fs::write(at.join("c.toml"), head + parameters).unwrap();
    let (code, said) = optimize(
        at,
        "c.toml",
        &["-o", "out", "--quiet", "--set", "render.spp=16"],
    );
    assert_eq!(code, Some(0), "{said}");
    errors(at)
}

#[test]
fn a_position_behind_silhouettes() {
    let found = run(
        "[parameters.\"card.translation\"]\nstart = [0.12, -0.08, 0]\n",
        "steps = 80",
    );
    assert!(found[0].1 < 0.1 * found[0].0, "{found:?}");
}

#[test]
fn colours_by_every_map() {
    for map in [
        "",
        "reparameterisation = \"log\"\n",
        "reparameterisation = \"logistic\"\nmin = 0\nmax = 1\n",
    ] {
        let parameters = format!(
            "[parameters.\"floor.bsdf.reflectance.value\"]\nstart = [0.5, 0.3, 0.3]\nlr = 0.1\n{map}"
        );
        let found = run(&parameters, "steps = 60");
        assert!(found[0].1 < 0.1 * found[0].0, "{map}: {found:?}");
    }
}

#[test]
fn a_size() {
    let found = run("[parameters.\"card.scale\"]\nstart = 1.3\n", "steps = 100");
    assert!(found[0].1 < 0.1 * found[0].0, "{found:?}");
}
