//! What is the user's own stays, whatever names jobs have.

use crate::jobs::{files, of_all_kinds, results, run, write};
use crate::workplace::workplace;
use serde_json::json;

#[test]
fn a_folder_of_ones_own_is_not_taken_for_a_jobs() {
    let directory = workplace();
    let at = directory.path();
    std::fs::create_dir_all(at.join("scenes/deep")).unwrap();
    std::fs::copy(at.join("s.xml"), at.join("scenes/s.xml")).unwrap();
    std::fs::write(at.join("scenes/deep/notes.txt"), "mine").unwrap();
    // One that looks like a job's but for a folder by the name of a file.
    std::fs::create_dir_all(at.join("odd/image.exr")).unwrap();
    let before = [files(&at.join("scenes")), files(&at.join("odd"))];
    let job = |id: &str| json!({"id": id, "mode": "render", "scene": "scenes/s.xml"});
    write(at, "jobs.jsonl", &[job("scenes"), job("odd"), job("good")]);
    run(at, "batch jobs.jsonl -o .", 5);
    let lines = results(at);
    let message = |id: &str| {
        let line = lines.iter().find(|line| line["id"] == id).unwrap();
        assert_eq!(line["code"], 3, "{line}");
        line["message"].as_str().unwrap().to_string()
    };
    assert!(message("scenes").contains("which is no job's: move it away"));
    assert!(message("odd").contains("odd: this folder holds image.exr"));
    assert_eq!(before, [files(&at.join("scenes")), files(&at.join("odd"))]);
    assert!(at.join("odd/image.exr").is_dir());
    assert!(at.join("good/image.exr").exists());
}

#[test]
fn nor_does_a_merge_take_it() {
    let directory = workplace();
    let at = directory.path();
    write(at, "jobs.jsonl", &of_all_kinds(3));
    for split in ["jobs", "samples"] {
        run(
            at,
            &format!("batch jobs.jsonl -q --shard 1/1 --split {split} -o {split}"),
            0,
        );
        let own = at.join("all").join("job-2");
        std::fs::create_dir_all(&own).unwrap();
        std::fs::write(own.join("notes.txt"), "mine").unwrap();
        let before = files(&at.join("all"));
        let out = run(at, &format!("merge {split} -o all"), 3);
        let message = String::from_utf8_lossy(&out.stderr);
        let said = "job-2: this folder holds notes.txt, which is no job's";
        assert!(message.contains(said), "{message}");
        let after = files(&at.join("all"));
        assert!(before.iter().all(|(name, bytes)| after[name] == *bytes));
        std::fs::remove_dir_all(at.join("all")).unwrap();
    }
}
