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

/// The report of a configuration of this repository.
fn of_scenes(config: &str, overrides: &[&str]) -> serde_json::Value {
    let directory = workplace();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let out = directory.path().join("out");
    let mut arguments = vec!["-o", out.to_str().unwrap(), "--quiet"];
    for set in overrides {
        arguments.extend(["--set", set]);
    }
    let (code, said) = optimize(&root, config, &arguments);
    assert_eq!(code, Some(0), "{said}");
    let report = std::fs::read_to_string(out.join("report.json")).unwrap();
    serde_json::from_str(&report).unwrap()
}

/// Requires that all parameters end nearer to the truth than a share of where they began.
fn arrives(report: &serde_json::Value, share: f64) {
    let all = report["parameter_errors"].as_array().unwrap();
    assert!(!all.is_empty());
    for e in all {
        let [start, end] = ["start", "end"].map(|name| e[name].as_f64().unwrap());
        assert!(end < share * start, "{e}");
    }
}

/// In pictures of a quarter of the size.
const SMALL: &str = "render.resolution=[32, 32]";

#[test]
fn roughness_from_a_reflection() {
    arrives(&of_scenes("optimize/roughness.toml", &[SMALL]), 0.03);
}

/// A ball becomes an object with dents and bumps.
#[test]
fn a_mesh_from_a_ball() {
    let report = of_scenes(
        "optimize/shape.toml",
        &[
            SMALL,
            "steps=60",
            "truth.spp=64",
            "output.turntable=0",
            "output.spp=4",
        ],
    );
    let found = &report["mesh_distances"][0];
    let [start, end] = ["start", "end"].map(|w| found[format!("chamfer_{w}")].as_f64().unwrap());
    assert!(end < 0.5 * start, "{found}");
}

/// What only its shadow shows is found by the borders of visibility, and not without them.
#[test]
fn an_object_seen_through_its_shadow() {
    let found = of_scenes("paper/optimize_pose.toml", &[SMALL]);
    let position = |report: &serde_json::Value| {
        let all = report["parameter_errors"].as_array().unwrap().clone();
        let named = |e: &serde_json::Value| e["key"] == "obj.translation";
        let e = all.into_iter().find(named).unwrap();
        e["end"].as_f64().unwrap() / e["start"].as_f64().unwrap()
    };
    assert!(position(&found) < 0.1, "{}", position(&found));
    let interior = [SMALL, "render.method=interior"];
    let without = of_scenes("paper/optimize_pose.toml", &interior);
    assert!(position(&without) > 0.9, "{}", position(&without));
}

#[cfg(feature = "long-tests")]
mod long {
    use super::*;

    #[test]
    fn every_ready_configuration_arrives() {
        for config in [
            "optimize/cornell_colours.toml",
            "optimize/pose.toml",
            "optimize/roughness.toml",
            "optimize/fence.toml",
            "optimize/reflection.toml",
            "paper/optimize_light.toml",
            "paper/optimize_pose.toml",
        ] {
            for seed in ["seed=1", "seed=2"] {
                arrives(&of_scenes(config, &[seed]), 0.1);
            }
        }
    }

    #[test]
    fn what_only_visibility_shows_is_not_found_without_it() {
        for config in [
            "optimize/fence.toml",
            "optimize/reflection.toml",
            "paper/optimize_pose.toml",
        ] {
            let report = of_scenes(config, &["render.method=interior"]);
            for e in report["parameter_errors"].as_array().unwrap() {
                let [start, end] = ["start", "end"].map(|name| e[name].as_f64().unwrap());
                assert!(end > 0.5 * start, "{config}: {e}");
            }
        }
    }

    /// Texels that no pixel sees stay where they were; where the view sees them they arrive.
    #[test]
    fn a_texture() {
        let report = of_scenes("paper/optimize_texture.toml", &[]);
        let e = &report["parameter_errors"][0];
        let [start, end] = ["seen_start", "seen_end"].map(|name| e[name].as_f64().unwrap());
        assert!(end < 0.05 * start, "{e}");
        assert!(e["end"].as_f64().unwrap() > 0.1 * start, "{e}");
    }

    #[test]
    fn meshes() {
        for (config, share) in [
            ("paper/optimize_mesh.toml", 0.35),
            ("optimize/shape.toml", 0.2),
            ("optimize/shape_texture_roughness.toml", 0.3),
        ] {
            let report = of_scenes(config, &["output.turntable=0"]);
            let found = &report["mesh_distances"][0];
            let [start, end] =
                ["start", "end"].map(|w| found[format!("chamfer_{w}")].as_f64().unwrap());
            assert!(end < share * start, "{config}: {found}");
        }
    }
}
