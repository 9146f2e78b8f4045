//! A shard that is not finished is not merged, and no job is lost.

use crate::jobs::{of_all_kinds, results, run, start, write};
use crate::workplace::{signal, workplace};
use serde_json::{Value, json};
use std::path::Path;

/// The merge of `a` and `b` is refused with these words, and leaves nothing.
fn refused(at: &Path, part: &str) {
    let out = run(at, "merge a b -o merged", 1);
    let message = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(message.contains(part), "{message}");
    assert!(!at.join("merged/results.jsonl").exists());
}

#[test]
fn a_shard_that_lacks_results_is_told() {
    let directory = workplace();
    let at = directory.path();
    write(at, "jobs.jsonl", &of_all_kinds(5));
    for split in ["jobs", "samples"] {
        for (folder, index) in [("a", 1), ("b", 2)] {
            let line = format!("--shard {index}/2 --split {split} -o {folder}");
            run(at, &format!("batch jobs.jsonl -q {line}"), 0);
        }
        // As a kill between two jobs leaves it. Of samples, neither shard has the last job.
        for folder in ["a", "b"] {
            let path = at.join(folder).join("results.jsonl");
            let last = if split == "jobs" && folder == "b" {
                "job-3"
            } else {
                "job-4"
            };
            let kept = results(&at.join(folder))
                .into_iter()
                .filter(|r| r["id"] != last);
            let kept: String = kept.map(|line| format!("{line}\n")).collect();
            std::fs::write(path, kept).unwrap();
        }
        let of = if split == "jobs" {
            "a: only 2 of 3 jobs"
        } else {
            "a: only 4 of 5 jobs"
        };
        refused(at, of);
        let resume = |folder: &str, index: u32| {
            let line = format!("--shard {index}/2 --split {split} -o {folder} --resume");
            run(at, &format!("batch jobs.jsonl -q {line}"), 0);
        };
        resume("a", 1);
        refused(at, "are done; run this shard again with --resume");
        resume("b", 2);
        // As an earlier version has left it.
        let path = at.join("b/batch.json");
        let text = std::fs::read(&path).unwrap();
        let mut manifest: Value = serde_json::from_slice(&text).unwrap();
        assert!(manifest.as_object_mut().unwrap().remove("count").is_some());
        std::fs::write(&path, manifest.to_string()).unwrap();
        refused(at, "does not say how many jobs there are");
        resume("b", 2);
        run(at, "merge a b -o merged", 0);
        assert_eq!(results(&at.join("merged")).len(), 5);
        for folder in ["a", "b", "merged"] {
            std::fs::remove_dir_all(at.join(folder)).unwrap();
        }
    }
}

#[test]
#[cfg(unix)]
fn a_shard_that_is_running_is_not_merged() {
    let directory = workplace();
    let at = directory.path();
    let mut jobs = of_all_kinds(2);
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -q --shard 1/2 -o a", 0);
    jobs[1]["spp"] = json!(1_000_000);
    write(at, "jobs.jsonl", &jobs);
    let child = start(at, "batch jobs.jsonl -q --shard 2/2 -o b");
    while !at.join("b/results.jsonl").exists() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    refused(at, "b: a batch is still writing there");
    signal(child.id(), "TERM");
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(143));
    refused(at, "b: only 0 of 1 jobs are done");
}
