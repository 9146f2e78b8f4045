//! Going on where an earlier run stopped.

use crate::jobs::{assert_same_files, of_all_kinds, results, run, write};
use crate::workplace::workplace;
use serde_json::json;

#[test]
fn what_is_done_stays_and_the_rest_is_run() {
    let directory = workplace();
    let at = directory.path();
    let jobs = of_all_kinds(10);
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o whole", 0);
    write(at, "jobs.jsonl", &jobs[..4]);
    run(at, "batch jobs.jsonl -o parts", 0);
    let first = std::fs::read_to_string(at.join("parts/results.jsonl")).unwrap();
    // A kill leaves half a line, folders without a line, and folders that are not complete.
    std::fs::write(
        at.join("parts/results.jsonl"),
        format!("{first}{{\"id\":\"job-4\","),
    )
    .unwrap();
    std::fs::create_dir(at.join("parts/job-5")).unwrap();
    std::fs::write(at.join("parts/job-5/image.exr"), "half").unwrap();
    std::fs::create_dir(at.join("parts/.job-6.unfinished")).unwrap();
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o parts --resume", 0);
    let second = std::fs::read_to_string(at.join("parts/results.jsonl")).unwrap();
    assert!(second.starts_with(&first));
    assert_eq!(results(&at.join("parts")).len(), 10);
    assert_same_files(&at.join("whole"), &at.join("parts"));
    run(at, "batch jobs.jsonl -o parts --resume", 0);
    let third = std::fs::read_to_string(at.join("parts/results.jsonl")).unwrap();
    assert_eq!(second, third, "nothing was left to be done");
}

#[test]
fn what_failed_is_tried_again_and_what_changed_is_refused() {
    let directory = workplace();
    let at = directory.path();
    let job = |seed: u32| {
        let good = json!({"id": "a", "mode": "render", "scene": "s.xml", "seed": seed});
        [
            good,
            json!({"id": "b", "mode": "render", "scene": "later.xml"}),
        ]
    };
    write(at, "jobs.jsonl", &job(1));
    run(at, "batch jobs.jsonl -o out", 5);
    std::fs::copy(at.join("s.xml"), at.join("later.xml")).unwrap();
    run(at, "batch jobs.jsonl -o out --resume", 0);
    let lines = results(&at.join("out"));
    assert_eq!(lines.len(), 2, "{lines:?}");
    write(at, "jobs.jsonl", &job(2));
    let out = run(at, "batch jobs.jsonl -o out --resume", 2);
    let message = String::from_utf8_lossy(&out.stderr);
    assert!(
        message.contains("line 1: the results have another job a"),
        "{message}"
    );
}
