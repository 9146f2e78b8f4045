//! Several processes share a batch; put together, it does not matter how many there were.

use crate::jobs::{assert_same_files, of_all_kinds, result, results, run, write};
use crate::workplace::workplace;
use serde_json::{Value, json};
use std::path::Path;

/// Runs all shards and merges them into `merged`, which is returned.
fn sharded(at: &Path, count: u32, split: &str) -> std::path::PathBuf {
    let mut folders = String::new();
    for index in 1..=count {
        let output = format!("{split}-{count}/{{shard}}");
        run(
            at,
            &format!(
                "batch jobs.jsonl -q -t 2 --shard {index}/{count} --split {split} -o {output}"
            ),
            0,
        );
        folders = format!("{split}-{count}/{index}-of-{count} {folders}");
    }
    let merged = format!("merged-{split}-{count}");
    run(at, &format!("merge {folders} -o {merged}"), 0);
    at.join(merged)
}

#[test]
fn shards_of_jobs_are_the_whole_batch() {
    let directory = workplace();
    let at = directory.path();
    write(at, "jobs.jsonl", &of_all_kinds(9));
    run(at, "batch jobs.jsonl -q -o whole", 0);
    for count in [1, 2, 5, 16] {
        let merged = sharded(at, count, "jobs");
        assert_same_files(&at.join("whole"), &merged);
        let ids: Vec<Value> = results(&merged).iter().map(|r| r["id"].clone()).collect();
        let wanted: Vec<Value> = (0..9).map(|i| json!(format!("job-{i}"))).collect();
        assert_eq!(ids, wanted);
    }
}

#[test]
fn shards_of_samples_add_up_to_the_same_bytes() {
    let directory = workplace();
    let at = directory.path();
    let mut jobs = of_all_kinds(5);
    jobs.push(json!({
        "id": "adjoint", "mode": "backward", "scene": "s.xml", "params": ["card.scale", "env.radiance.value"],
        "adjoint": "target.npy", "spp": 32, "outputs": ["gradients.npz"]
    }));
    for job in &mut jobs {
        // Twenty groups: as many as no number of shards divides.
        job["spp"] = json!(20);
        job["groups"] = json!(20);
    }
    jobs[1]["stderr"] = json!(false);
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -q -o whole", 0);
    let mut first: Option<Vec<Value>> = None;
    for count in [1, 2, 5, 16] {
        let merged = sharded(at, count, "samples");
        assert_same_files(&at.join("whole"), &merged);
        let mut lines = results(&merged);
        for line in &mut lines {
            let whole = result(&at.join("whole"), line["id"].as_str().unwrap());
            assert_eq!(
                (&line["norms"], &line["loss"]),
                (&whole["norms"], &whole["loss"])
            );
            // Each process that has a part renders the image behind a loss.
            line.as_object_mut().unwrap().remove("rays");
        }
        assert_eq!(*first.get_or_insert(lines.clone()), lines, "{count}");
    }
}

#[test]
fn without_groups_a_job_is_shared_out_among_sixteen_or_more() {
    let directory = workplace();
    let at = directory.path();
    let job = json!({"id": "a", "mode": "render", "scene": "s.xml", "spp": 36});
    write(at, "jobs.jsonl", &[job]);
    let merged = [1, 5].map(|count| sharded(at, count, "samples"));
    assert_same_files(&merged[0], &merged[1]);
    let share = result(&at.join("samples-5/2-of-5"), "a")["share"].clone();
    assert_eq!(
        (&share["groups"], &share["done"]),
        (&json!(18), &json!([1, 6, 11, 16]))
    );
}

#[test]
fn unlike_shards_are_not_merged() {
    let directory = workplace();
    let at = directory.path();
    let jobs = of_all_kinds(4);
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -q --shard 1/2 -o a", 0);
    run(at, "batch jobs.jsonl -q --shard 2/2 -o b", 0);
    run(at, "batch jobs.jsonl -q --shard 2/3 -o c", 0);
    run(
        at,
        "batch jobs.jsonl -q --shard 2/2 --split samples -o d",
        0,
    );
    run(
        at,
        "batch jobs.jsonl -q --shard 2/2 --backend obvhs -o f",
        if cfg!(feature = "obvhs") { 0 } else { 2 },
    );
    write(at, "jobs.jsonl", &jobs[..3]);
    run(at, "batch jobs.jsonl -q --shard 2/2 -o e", 0);
    let said = |line: &str, part: &str| {
        let out = run(at, &format!("{line} -o merged"), 1);
        let message = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(message.contains(part), "{line}: {message}");
        assert!(!at.join("merged/results.jsonl").exists());
    };
    said("merge a", "shard 2/2 is missing");
    said("merge a b b", "b and b both hold shard 2/2");
    said("merge a c", "not of one batch");
    said("merge a d", "not of one batch");
    if cfg!(all(feature = "embree", feature = "obvhs")) {
        said("merge a f", "on obvhs");
    }
    said("merge a e", "different job files");
    let text = std::fs::read_to_string(at.join("b/results.jsonl")).unwrap();
    std::fs::write(at.join("b/results.jsonl"), &text[..text.len() - 9]).unwrap();
    said("merge a b", "run this shard again with --resume");
    write(at, "jobs.jsonl", &jobs);
    let out = run(at, "batch jobs.jsonl --shard 1/2 -o b --resume", 2);
    assert!(String::from_utf8_lossy(&out.stderr).contains("b holds shard 2/2"));
    run(at, "batch jobs.jsonl --shard 2/2 -o b --resume", 0);
    run(at, "merge a b -o merged", 0);
}

/// What the manifest in docs/scaling.md starts, with the variable that Kubernetes sets.
#[test]
fn the_kubernetes_recipe_runs() {
    let directory = workplace();
    let at = directory.path();
    write(at, "jobs.jsonl", &of_all_kinds(4));
    run(at, "batch jobs.jsonl -q -o whole", 0);
    let page = std::fs::read_to_string("docs/scaling.md").unwrap();
    let line = page
        .lines()
        .find_map(|line| line.trim().strip_prefix("command: [warpath, "));
    let command = line.unwrap().trim_end_matches(']').replace('"', "");
    let command: Vec<&str> = command.split(", ").collect();
    assert!(page.contains("completions: 16") && command.contains(&"auto/16"));
    for index in 0..16 {
        let out = std::process::Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(&command)
            .env("JOB_COMPLETION_INDEX", index.to_string())
            .current_dir(at)
            .output()
            .unwrap();
        assert_eq!(
            out.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&out.stderr)
        );
    }
    let folders: Vec<String> = (1..=16).map(|i| format!("out/{i}-of-16")).collect();
    run(at, &format!("merge {} -o merged", folders.join(" ")), 0);
    assert_same_files(&at.join("whole"), &at.join("merged"));
}

#[test]
fn the_environment_tells_the_shard() {
    let directory = workplace();
    let at = directory.path();
    write(at, "jobs.jsonl", &of_all_kinds(4));
    let environments: [&[(&str, &str)]; 4] = [
        &[
            ("SLURM_ARRAY_TASK_ID", "8"),
            ("SLURM_ARRAY_TASK_COUNT", "2"),
            ("SLURM_ARRAY_TASK_MIN", "7"),
        ],
        &[("OMPI_COMM_WORLD_RANK", "1"), ("OMPI_COMM_WORLD_SIZE", "2")],
        &[("PMI_RANK", "1"), ("PMI_SIZE", "2")],
        &[("JOB_COMPLETION_INDEX", "1")],
    ];
    for (number, variables) in environments.into_iter().enumerate() {
        let auto = if variables.len() == 1 {
            "auto/2"
        } else {
            "auto"
        };
        let line = format!("batch jobs.jsonl -q --shard {auto} -o out-{number}/{{shard}}");
        let out = std::process::Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(line.split_whitespace())
            .envs(variables.iter().copied())
            .current_dir(at)
            .output()
            .unwrap();
        assert_eq!(
            out.status.code(),
            Some(0),
            "{}",
            String::from_utf8_lossy(&out.stderr)
        );
        let lines = results(&at.join(format!("out-{number}/2-of-2")));
        let mut ids: Vec<_> = lines.iter().map(|r| r["id"].as_str().unwrap()).collect();
        ids.sort_unstable();
        assert_eq!(ids, ["job-1", "job-3"]);
    }
}
