//! Numbers beyond single precision: no file ever holds what is not finite, and what can be computed
//! is.

use crate::workplace::{expect, floats, npy, text, typed, warpath};
use std::path::Path;
use warpath::output::tensors::TensorFile;

const SCENE: &str = r#"<scene version="3.0.0">
  <default name="radiance" value="1"/><default name="side" value="1"/><default name="away" value="4"/>
  <default name="turn" value="120"/><default name="x" value="-2.5"/>
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective" id="cam">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 1, $away" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="16"/></sampler>
    <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="6"/></film>
  </sensor>
  <shape type="rectangle" id="floor"><transform name="to_world"><scale value="$side"/></transform></shape>
  <shape type="rectangle" id="lamp">
    <transform name="to_world"><rotate y="1" angle="$turn"/><translate x="$x" z="1.5"/></transform>
    <emitter type="area"><rgb name="radiance" value="$radiance"/></emitter>
  </shape>
</scene>
"#;

fn place() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    std::fs::write(directory.path().join("s.xml"), SCENE).unwrap();
    npy(
        directory.path(),
        "black.npy",
        "<f4",
        "(6, 8, 3)",
        &floats(144, 0.0),
    );
    directory
}

/// Numbers that no scene needs, each with its message.
const SILENT: [(&str, &str); 3] = [
    (
        r#"<shape type="cube"><bsdf type="roughconductor"><rgb name="k" value="1e20"/></bsdf></shape>"#,
        r#""k" must be between 0 and 1000000"#,
    ),
    (
        r#"<sensor type="perspective" id="other"><float name="fov" value="40"/><float name="principal_point_offset_x" value="1e25"/></sensor>"#,
        "other: the principal point is 10000000000000000000000000 and 0 films away",
    ),
    (
        r#"<emitter type="point" id="bulb"><point name="position" x="0" y="0" z="1e20"/></emitter>"#,
        "bulb: (0e0, 0e0, 1e20) is too far",
    ),
];

#[test]
fn numbers_that_leave_nothing_to_see_are_refused() {
    for (line, message) in SILENT {
        let directory = place();
        let scene = SCENE.replace("</scene>", &format!("{line}</scene>"));
        std::fs::write(directory.path().join("s.xml"), scene).unwrap();
        let sensor = if line.starts_with("<sensor") {
            "--sensor 1"
        } else {
            ""
        };
        let command = format!("render s.xml {sensor} -o o");
        expect(directory.path(), &[(command.as_str(), 3, message)]);
    }
}

const FINITE: &str = "is not finite: numbers of this scene";
const FAR: &str = "is too far from the origin: single precision reaches to 1e9";

#[test]
fn what_is_not_finite_is_no_result() {
    let directory = place();
    let table = [
        (
            "render s.xml -D radiance=3.4e38 -D turn=0 -D x=0 -o a",
            3,
            FINITE,
        ),
        (
            "forward s.xml -D radiance=3.4e38 -D turn=0 -D x=0 --param lamp.translation=1e4,0,0 -o b",
            3,
            FINITE,
        ),
        (
            "backward s.xml -D radiance=1e25 --param lamp.translation --target black.npy -o c",
            3,
            "lamp.translation is not finite",
        ),
        ("render s.xml -D side=1e17 -o d", 3, FAR),
        ("render s.xml -D away=2e18 -o e", 3, FAR),
        ("render s.xml -D away=1e30 -o f", 3, FAR),
        (
            "forward s.xml -D away=2e18 --param floor.translation=1,0,0 --method fd -o g",
            3,
            FAR,
        ),
    ];
    expect(directory.path(), &table);
    for name in ["a", "b", "c", "d", "e", "f", "g"] {
        let files = std::fs::read_dir(directory.path().join(name));
        assert!(files.is_err() || files.unwrap().count() == 0, "{name}");
    }
}

fn gradient(directory: &Path, line: &str, key: &str) -> Vec<f64> {
    let out = warpath(directory, &typed(line));
    assert!(out.status.success(), "{line}: {}", text(&out.stderr));
    let file = TensorFile::open(&directory.join("o/gradients.safetensors")).unwrap();
    let values = file.get(key).unwrap().values;
    values.into_iter().map(f64::from).collect()
}

/// A loss that is quadratic in the radiance has a derivative that is linear in it, with the same
/// samples.
#[test]
fn losses_may_be_larger_than_single_precision() {
    let directory = place();
    let line = |radiance: &str| {
        format!(
            "backward s.xml -D radiance={radiance} --param lamp.emitter.radiance.value --target black.npy -o o"
        )
    };
    let key = "lamp.emitter.radiance.value";
    let one = gradient(directory.path(), &line("1"), key);
    assert!(one.iter().all(|g| *g > 1e-4), "{one:?}");
    for large in ["1e25", "1e-20"] {
        let many = gradient(directory.path(), &line(large), key);
        let factor: f64 = large.parse().unwrap();
        for (one, many) in one.iter().zip(many) {
            let relative = many / (one * factor) - 1.0;
            assert!(relative.abs() < 1e-4, "{large}: {many:e} for {one:e}");
        }
    }
}

/// Embree is built with assertions on Debian: one such job took all others with it.
#[test]
fn a_job_whose_camera_is_too_far_fails_alone() {
    let directory = place();
    let job =
        |id: &str, rest: &str| format!(r#"{{"id":"{id}","mode":"render","scene":"s.xml"{rest}}}"#);
    let moved = |to: &str| format!(r#","set":{{"cam.translation":[0,0,{to}]}}"#);
    let lines = [
        job("a", ""),
        job("far", &moved("3e18")),
        // Embree asserts while it refits.
        job(
            "far-floor",
            r#","set":{"floor.translation":[0.7,0.7,3.4e38]}"#,
        ),
        job("farther", &moved("1e38")),
        job("b", ""),
    ];
    std::fs::write(directory.path().join("jobs.jsonl"), lines.join("\n")).unwrap();
    let out = warpath(directory.path(), &typed("batch jobs.jsonl -o o"));
    assert_eq!(out.status.code(), Some(5), "{}", text(&out.stderr));
    let results = std::fs::read_to_string(directory.path().join("o/results.jsonl")).unwrap();
    assert_eq!(results.lines().count(), 5);
    for line in results.lines() {
        let line: serde_json::Value = serde_json::from_str(line).unwrap();
        let (id, code) = (line["id"].as_str().unwrap(), line["code"].as_i64());
        assert_eq!(
            code,
            Some(if id.starts_with("far") { 3 } else { 0 }),
            "{line}"
        );
    }
}
