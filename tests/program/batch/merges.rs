//! What a merge says, and what it leaves where it fails.

use crate::jobs::{files, of_all_kinds, results, run, write};
use crate::workplace::{text, workplace};
use serde_json::{Value, json};
use std::path::Path;

/// Two shards, in `a` and `b`.
fn shards(at: &Path, split: &str) {
    write(at, "jobs.jsonl", &of_all_kinds(5));
    for (folder, index) in [("a", 1), ("b", 2)] {
        let line = format!("--shard {index}/2 --split {split} -o {folder}");
        run(at, &format!("batch jobs.jsonl -q {line}"), 0);
    }
}

#[test]
fn it_writes_a_report() {
    for split in ["jobs", "samples"] {
        let directory = workplace();
        let at = directory.path();
        shards(at, split);
        let out = run(at, "merge a b -o all --json", 0);
        let written = std::fs::read(at.join("all/report.json")).unwrap();
        assert_eq!(out.stdout, written);
        let report: Value = serde_json::from_slice(&written).unwrap();
        assert_eq!(
            (&report["command"], &report["jobs"], &report["shards"]),
            (&json!("merge"), &json!(5), &json!(2))
        );
        assert_eq!(
            report["arguments"],
            json!(["merge", "a", "b", "-o", "all", "--json"])
        );
        let mut listed: Vec<&str> = report["files"]
            .as_array()
            .unwrap()
            .iter()
            .map(|f| f.as_str().unwrap())
            .collect();
        listed.sort_unstable();
        let mut there: Vec<String> = files(&at.join("all")).into_keys().collect();
        there.extend(["report.json".into(), "results.jsonl".into()]);
        there.sort_unstable();
        assert_eq!(listed, there);
        let rays = |line: &Value| line["rays"]["camera"].as_u64().unwrap_or(0);
        let all: u64 = results(&at.join("all")).iter().map(rays).sum();
        assert_eq!(rays(&report), all);
        assert!(report["seconds"]["total"].as_f64() > Some(0.0));
    }
}

#[test]
fn what_cannot_be_read_is_told_before_anything_is_written() {
    for split in ["jobs", "samples"] {
        let directory = workplace();
        let at = directory.path();
        shards(at, split);
        let name = match split {
            "jobs" => "a/job-4/gradients.npz",
            _ => "b/job-4/partial.safetensors",
        };
        let whole = std::fs::read(at.join(name)).unwrap();
        std::fs::remove_file(at.join(name)).unwrap();
        let message = text(&run(at, "merge a b -o all", 3).stderr);
        assert!(
            message.contains(&format!("{name}: No such file")),
            "{message}"
        );
        assert!(!message.contains("cannot be written"), "{message}");
        assert!(!at.join("all").exists());
        std::fs::write(at.join(name), whole).unwrap();
        run(at, "merge a b -o all", 0);
        let message = text(&run(at, "merge a b -o all", 2).stderr);
        let said = "all/results.jsonl has results already: choose another -o\n";
        assert!(message.ends_with(said), "{message}");
    }
}

/// As a full disk leaves it: no results say that all is there, and it can be done again.
#[test]
#[cfg(unix)]
fn a_merge_that_failed_is_done_again() {
    let directory = workplace();
    let at = directory.path();
    shards(at, "jobs");
    // A file in place of a folder of the last job, which is found when it is written.
    std::fs::create_dir(at.join("all")).unwrap();
    std::fs::write(at.join("all/.job-4.unfinished"), "").unwrap();
    let message = text(&run(at, "merge a b -o all", 4).stderr);
    assert!(
        message.contains(".job-4.unfinished: cannot be written"),
        "{message}"
    );
    assert!(at.join("all/job-3").exists() && !at.join("all/results.jsonl").exists());
    std::fs::remove_file(at.join("all/.job-4.unfinished")).unwrap();
    run(at, "merge a b -o all", 0);
    assert_eq!(results(&at.join("all")).len(), 5);
}

/// A read that the system fails, as of a disk that is broken: this file's is one for everybody.
#[test]
#[cfg(target_os = "linux")]
fn what_the_system_does_not_read_is_no_bad_input() {
    let directory = workplace();
    let at = directory.path();
    shards(at, "jobs");
    for name in ["results.jsonl", "batch.json"] {
        let path = at.join("b").join(name);
        std::fs::remove_file(&path).unwrap();
        std::os::unix::fs::symlink("/proc/self/mem", &path).unwrap();
        let message = text(&run(at, "merge a b -o all", 4).stderr);
        assert!(message.contains(&format!("b/{name}: ")), "{message}");
        assert!(!at.join("all").exists());
    }
}
