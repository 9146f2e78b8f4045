//! A full disk: what does not fit fails, and everything else is intact.

#![cfg(unix)]

use crate::jobs::{assert_same_files, files, results, run, write};
use crate::workplace::workplace;
use serde_json::json;
use std::process::Command;

/// Files may not grow beyond 16 KB: writing more fails as it does on a full disk.
fn with_small_files(directory: &std::path::Path, line: &str) -> std::process::Output {
    let script = format!(
        "ulimit -f 16; trap '' XFSZ; exec {} {line}",
        env!("CARGO_BIN_EXE_warpath")
    );
    // In dash the limit counts blocks of 512 bytes, in bash of 1024.
    let mut shell = Command::new("bash");
    shell
        .args(["-c", &script])
        .current_dir(directory)
        .output()
        .unwrap()
}

#[test]
fn what_does_not_fit_fails_alone() {
    let directory = workplace();
    let at = directory.path();
    let job = |id: &str, side: u32| {
        json!({"id": id, "mode": "forward", "scene": "s.xml", "params": {"card.translation": [1, 0, 0]},
               "resolution": [side, side], "outputs": ["gradient.npy"]})
    };
    write(
        at,
        "jobs.jsonl",
        &[job("a", 8), job("large", 100), job("b", 9)],
    );
    run(at, "batch jobs.jsonl -o whole", 0);
    let out = with_small_files(at, "batch jobs.jsonl -o small");
    let message = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(5), "{message}");
    let lines = results(&at.join("small"));
    let failed: Vec<_> = lines.iter().filter(|l| l["status"] == "failed").collect();
    assert_eq!((lines.len(), failed.len()), (3, 1), "{lines:?}");
    assert_eq!(
        (&failed[0]["id"], &failed[0]["code"]),
        (&json!("large"), &json!(4))
    );
    let told = failed[0]["message"].as_str().unwrap();
    assert!(told.contains("gradient.npy: cannot be written"), "{told}");
    let names: Vec<String> = files(&at.join("small")).into_keys().collect();
    assert_eq!(names, ["a/gradient.npy", "b/gradient.npy"]);
    run(at, "batch jobs.jsonl -o small --resume", 0);
    assert_same_files(&at.join("whole"), &at.join("small"));
}

#[test]
fn results_that_cannot_be_written_end_the_batch_and_are_resumed() {
    let directory = workplace();
    let at = directory.path();
    let jobs: Vec<_> = (0..80)
        .map(|i| {
            json!({"id": format!("{i}-{}", "x".repeat(100)), "mode": "render", "scene": "s.xml", "resolution": [2, 2]})
        })
        .collect();
    write(at, "jobs.jsonl", &jobs);
    let out = with_small_files(at, "batch jobs.jsonl -o out -q");
    let message = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(4), "{message}");
    assert!(
        message.contains("results.jsonl: cannot be written"),
        "{message}"
    );
    let before = results(&at.join("out"));
    assert!((1..80).contains(&before.len()), "{}", before.len());
    run(at, "batch jobs.jsonl -o out -q --resume", 0);
    let after = results(&at.join("out"));
    assert_eq!(after.len(), 80);
    assert_eq!(after[..before.len()], before);
}
