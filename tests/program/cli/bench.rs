//! `warpath bench` on a small scene, as quickly as it goes.

use crate::workplace::{expect, text, typed, warpath, workplace};
use serde_json::Value;
use std::collections::BTreeMap;

#[test]
fn a_bench_measures_every_backend_and_writes_it_down() {
    let directory = workplace();
    let line = "bench s.xml --seconds 0.001 --threads 2 --json --quiet -o out";
    let out = warpath(directory.path(), &typed(line));
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    assert!(out.stderr.is_empty(), "{}", text(&out.stderr));
    let file =
        |name: &str| std::fs::read_to_string(directory.path().join("out").join(name)).unwrap();
    assert_eq!(file("bench.json"), text(&out.stdout));
    assert!(file("bench.svg").contains("diffuse bounce") && file("report.json").contains("bench"));
    let results: Value = serde_json::from_slice(&out.stdout).unwrap();
    let mut met: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for record in results["records"].as_array().unwrap() {
        let number = |key: &str| record[key].as_f64().unwrap();
        assert!(
            number("low") > 0.0 && number("low") <= number("median"),
            "{record}"
        );
        assert!(
            number("median") <= number("high") && number("high").is_finite(),
            "{record}"
        );
        let what = record["what"].as_str().unwrap();
        if let Some(rays) = record["rays"].as_f64() {
            met.entry(what).or_default().push(rays);
        }
        assert!(
            record["backend"]
                .as_str()
                .unwrap()
                .parse::<warpath::trace::Backend>()
                .is_ok()
        );
    }
    for what in [
        "primary",
        "bundle 0.001 rad",
        "bundle 0.01 rad",
        "bundle 0.1 rad",
        "diffuse bounce",
        "gradient",
    ] {
        let met = &met[what];
        // Robust and leaky ways of all libraries see the same scene.
        let (least, most) = met
            .iter()
            .fold((f64::MAX, 0.0f64), |(l, m), &x| (l.min(x), m.max(x)));
        assert!(
            met.len() >= 4 && most - least <= 1e-3 * most,
            "{what}: {met:?}"
        );
    }
}

#[test]
fn all_files_are_looked_at_before_the_first_is_measured() {
    let directory = workplace();
    let all = [("bench s.xml missing.xml -q -o out", 3, "missing.xml")];
    expect(directory.path(), &all);
    assert!(!directory.path().join("out").exists());
}

#[test]
fn what_this_build_lacks_is_refused() {
    let directory = workplace();
    let all: [(&str, bool, &str); 4] = [
        (
            "render s.xml --backend embree -q",
            cfg!(feature = "embree"),
            "built without Embree: use --backend obvhs",
        ),
        (
            "render s.xml --backend embree:high -q",
            cfg!(feature = "embree"),
            "built without Embree",
        ),
        (
            "render s.xml --backend obvhs -q",
            cfg!(feature = "obvhs"),
            "built without obvhs: use --backend embree",
        ),
        (
            "render s.xml --backend obvhs-bvh2:fastest -q",
            cfg!(feature = "obvhs"),
            "built without obvhs",
        ),
    ];
    let expected = all.map(|(line, there, why)| if there { (line, 0, "") } else { (line, 2, why) });
    expect(directory.path(), &expected);
}
