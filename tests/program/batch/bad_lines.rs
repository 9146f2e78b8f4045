//! A bad line fails alone, with its number and what would be right.

use crate::jobs::{results, run};
use crate::workplace::workplace;

const GOOD: &str = r#"{"id":"good","mode":"render","scene":"s.xml"}"#;

/// Lines, the code with which each fails, and what its message says.
// Long: one table, a line in each row.
fn bad_lines() -> Vec<(String, i32, &'static str)> {
    let job = |rest: &str| format!(r#"{{"id":"x","scene":"s.xml",{rest}}}"#);
    let forward = |rest: &str| job(&format!(r#""mode":"forward","params":{{{rest}}}"#));
    let backward = |rest: &str| {
        job(&format!(
            r#""mode":"backward","params":["card.translation"],{rest}"#
        ))
    };
    let set = |rest: &str| job(&format!(r#""mode":"render","set":{{{rest}}}"#));
    vec![
        (
            "rubbish".to_string(),
            3,
            "not JSON: expected value (column 1)",
        ),
        ("{}".into(), 3, "missing field `id`"),
        (
            r#"["x","render","s.xml"]"#.into(),
            3,
            "a job is a JSON object",
        ),
        (job(r#""mode":"render"} {"#), 3, "trailing"),
        (job(r#""mode":"paint""#), 3, "mode: unknown variant `paint`"),
        (
            job(r#""mode":"render","sppp":3"#),
            3,
            "unknown field `sppp`",
        ),
        (
            job(r#""mode":"render","spp":0"#),
            3,
            "spp: write a whole number from 1",
        ),
        (job(r#""mode":"render","spp":-1"#), 3, "spp: invalid value"),
        (
            job(r#""mode":"render","spp":"many""#),
            3,
            "spp: invalid type",
        ),
        (
            job(r#""mode":"render","seed":1.5"#),
            3,
            "seed: invalid type",
        ),
        (
            job(r#""mode":"render","max_depth":0"#),
            3,
            "max_depth: write",
        ),
        (
            job(r#""mode":"render","resolution":[0,8]"#),
            3,
            "resolution: each side",
        ),
        (
            job(r#""mode":"render","resolution":"8 by 8""#),
            3,
            "resolution: write width x height",
        ),
        (
            job(r#""mode":"render","resolution":[65536,65536]"#),
            3,
            "pixels are too many",
        ),
        (
            job(r#""mode":"render","sensor":2"#),
            3,
            "the scene has 2 sensors, counted from 0: cam, second",
        ),
        (
            job(r#""mode":"render","params":["card.translation"]"#),
            3,
            "params: render takes none",
        ),
        (
            job(r#""mode":"render","groups":3,"spp":8"#),
            3,
            "cannot be parted into 3",
        ),
        (
            job(r#""mode":"render","outputs":["image.tiff"]"#),
            3,
            "it writes image.exr, image.png",
        ),
        (
            forward(
                r#""card.translation":[1,0,0]},"stderr":false,"outputs":["stderr.npy"],"defines":{"#,
            ),
            3,
            "outputs: stderr.npy is asked for, and \"stderr\": false leaves it out",
        ),
        (
            job(r#""mode":"render","defines":{"side":[8]}"#),
            3,
            "defines.side: a text, a number",
        ),
        (
            job(r#""mode":"render","defines":{"side":"wide"}"#),
            3,
            "wide",
        ),
        (
            job(r#""mode":"render","defines":{"side":8,"side":9}"#),
            3,
            "\"side\" is given twice",
        ),
        (
            job(r#""mode":"forward""#),
            3,
            "params: forward needs tangents",
        ),
        (
            job(r#""mode":"forward","params":["card.translation"]"#),
            3,
            "params: forward needs tangents",
        ),
        (
            forward(r#""card.translatoin":[1,0,0]"#),
            3,
            "the nearest is \"card.translation\"",
        ),
        (
            forward(r#""card.translation":[1,0]"#),
            3,
            "takes 3 numbers; 2 are given",
        ),
        (
            forward(r#""card.translation":[1,[0]]"#),
            3,
            "params.card.translation: its rows",
        ),
        (
            forward(r#""card.translation":null"#),
            3,
            "params.card.translation: invalid type: null",
        ),
        (
            forward(r#""card.translation":"four.npy""#),
            3,
            "four.npy: the shape is (4,), card.translation has (3,)",
        ),
        (forward(r#""card.translation":"none.npy""#), 3, "none.npy"),
        (
            forward(r#""second.translation":[1,0,0]"#),
            3,
            "belongs to sensor 1",
        ),
        (backward(r#""seed":1"#), 3, "needs an adjoint or a target"),
        (
            backward(r#""target":"target.npy","adjoint":"target.npy""#),
            3,
            "either",
        ),
        (
            backward(r#""adjoint":"target.npy","loss":"l2""#),
            3,
            "loss: it belongs to a target",
        ),
        (
            backward(r#""target":"target.npy","loss":"l3""#),
            3,
            "loss: unknown variant `l3`",
        ),
        (
            backward(r#""target":"small.npy""#),
            3,
            "small.npy: 4x4 pixels, the image rendered has 8x6",
        ),
        (backward(r#""target":"nan.npy""#), 3, "not finite"),
        (
            set(r#""card.vertex_positions":"three.npy""#),
            3,
            "three.npy: the shape is (3,), card.vertex_positions has (4, 3)",
        ),
        (
            set(r#""card.vertex_positions":[0,0,0]"#),
            3,
            "the shape is (3,), card.vertex_positions has (4, 3)",
        ),
        (
            set(r#""card.positions":[0,0,0],"card.vertex_positions":[0,0,0]"#),
            3,
            "card.vertex_positions is given twice",
        ),
        (set(r#""card.scale":-1"#), 3, "a scale is greater than zero"),
        (
            set(r#""floor.bsdf.reflectance.value":[2,0,0]"#),
            3,
            "2 is not between 0 and 1",
        ),
        (set(r#""card.bsdf":1"#), 3, "card.bsdf"),
        (
            r#"{"id":"../up","mode":"render","scene":"s.xml"}"#.into(),
            3,
            "cannot name a folder",
        ),
        (
            r#"{"id":".x","mode":"render","scene":"s.xml"}"#.into(),
            3,
            "cannot name a folder",
        ),
        (
            r#"{"id":"results.jsonl","mode":"render","scene":"s.xml"}"#.into(),
            3,
            "the batch's own",
        ),
        (
            r#"{"id":"y","mode":"render","scene":"none.xml"}"#.into(),
            3,
            "none.xml",
        ),
        (
            r#"{"id":"good","mode":"render","scene":"s.xml"}"#.into(),
            3,
            "id: good is that of line 1 already",
        ),
    ]
}

#[test]
fn bad_lines_fail_alone() {
    let directory = workplace();
    let at = directory.path();
    for (number, (line, code, part)) in bad_lines().iter().enumerate() {
        let output = format!("out-{number}");
        std::fs::write(at.join("jobs.jsonl"), format!("{GOOD}\n\n{line}\n")).unwrap();
        let out = run(at, &format!("batch jobs.jsonl -o {output} -t 1"), 5);
        let results = results(&at.join(&output));
        assert_eq!(results.len(), 2, "{line}");
        let good = results.iter().find(|r| r["status"] == "ok").unwrap();
        assert_eq!(good["id"], "good");
        assert!(at.join(&output).join("good/image.exr").exists());
        let bad = results.iter().find(|r| r["status"] == "failed").unwrap();
        assert_eq!(bad["code"], *code, "{line}");
        assert_eq!(bad["line"], 3, "{line}");
        let message = bad["message"].as_str().unwrap();
        assert!(
            message.starts_with("line 3: ") && message.contains(part),
            "{line}: {message}"
        );
        let told = String::from_utf8_lossy(&out.stderr);
        assert!(told.contains("1 of 2 jobs failed"), "{told}");
    }
}

#[test]
fn wrong_usage_of_batch_and_merge_is_told() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("jobs.jsonl"), GOOD).unwrap();
    run(at, "batch jobs.jsonl -o done", 0);
    crate::workplace::expect(
        at,
        &[
            ("batch", 2, "JOBS"),
            ("batch none.jsonl -o none", 3, "none.jsonl"),
            ("batch . -o none", 3, "."),
            ("batch a_file/x -o none", 3, "a_file/x: Not a directory"),
            ("batch jobs.jsonl -o a_file", 4, "a_file"),
            ("batch jobs.jsonl -o done", 2, "--resume goes on"),
            ("batch jobs.jsonl --shard 0/2", 2, "counted from 1"),
            ("batch jobs.jsonl --shard 1", 2, "I/N"),
            (
                "batch jobs.jsonl --shard auto -o none",
                2,
                "write --shard I/N",
            ),
            ("batch jobs.jsonl --split samples", 2, "--shard"),
            ("batch - --shard 1/2", 2, "a stream is for one worker"),
            ("batch jobs.jsonl --memory much", 2, "as in 8G"),
            ("merge", 2, "<DIR>"),
            ("merge nowhere -o none", 3, "nowhere"),
        ],
    );
    assert!(!at.join("none").exists());
}
