//! Batches for tests: job files, the program run on them, and what it leaves.

use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Every mode, on one scene with two values of a `$name`, with moved vertices, poses and colours.
pub fn of_all_kinds(count: usize) -> Vec<Value> {
    (0..count)
        .map(|i| {
            let shift = 0.01 * i as f64;
            let mut job = match i % 5 {
                0 => json!({"mode": "render"}),
                1 => json!({"mode": "forward", "params": {"card.translation": [1, 0, 0], "cam.x_fov": 2}}),
                2 => json!({"mode": "backward", "params": ["card.vertex_positions"], "target": "target.npy"}),
                3 => json!({
                    "mode": "forward", "params": {"card.rotation": [0, 0, 1]},
                    "set": {"card.translation": [shift, 0, 0.1]}
                }),
                _ => json!({
                    "mode": "backward", "params": ["floor.bsdf.reflectance.value", "card.translation"],
                    "set": {"floor.bsdf.reflectance.value": [0.3, shift, 0.1], "card.rotation": [0, 0, shift]},
                    "target": "target.npy", "loss": "l1"
                }),
            };
            job["id"] = json!(format!("job-{i}"));
            job["scene"] = json!("s.xml");
            let filter = ["box", "gaussian"][i % 3 / 2];
            job["defines"] = json!({"count": 8 + 8 * (i % 2), "filter": filter});
            job["seed"] = json!(i);
            job
        })
        .collect()
}

/// Writes a job file.
pub fn write(directory: &Path, name: &str, jobs: &[Value]) {
    let lines: Vec<String> = jobs.iter().map(Value::to_string).collect();
    std::fs::write(directory.join(name), lines.join("\n") + "\n").unwrap();
}

/// Starts the program with arguments split at spaces.
pub fn start(directory: &Path, line: &str) -> Child {
    Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(line.split_whitespace())
        .current_dir(directory)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Runs the program, and holds its exit code to `code`.
pub fn run(directory: &Path, line: &str, code: i32) -> Output {
    let out = start(directory, line).wait_with_output().unwrap();
    let message = String::from_utf8_lossy(&out.stderr);
    assert_eq!(out.status.code(), Some(code), "{line}: {message}");
    assert!(!message.contains("panicked"), "{line}: {message}");
    out
}

/// The lines of `results.jsonl`.
pub fn results(directory: &Path) -> Vec<Value> {
    let text = std::fs::read_to_string(directory.join("results.jsonl")).unwrap();
    let lines = text.lines().map(|line| serde_json::from_str(line).unwrap());
    lines.collect()
}

/// The result of one job, which must stand once.
pub fn result(directory: &Path, id: &str) -> Value {
    let mut found = results(directory).into_iter().filter(|r| r["id"] == id);
    let result = found.next().unwrap_or_else(|| panic!("no result of {id}"));
    assert!(found.next().is_none(), "{id} stands twice");
    result
}

/// All files below a folder, but those of the batch itself.
pub fn files(directory: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    collect(directory, "", &mut found);
    for own in ["results.jsonl", "report.json", "batch.json"] {
        found.remove(own);
    }
    found
}

fn collect(directory: &Path, prefix: &str, found: &mut BTreeMap<String, Vec<u8>>) {
    for entry in std::fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let name = format!("{prefix}{name}");
        match path.is_dir() {
            true => collect(&path, &format!("{name}/"), found),
            false => drop(found.insert(name, std::fs::read(&path).unwrap())),
        }
    }
}

/// Asserts that two folders hold the same files, byte for byte.
pub fn assert_same_files(a: &Path, b: &Path) {
    let (a, b) = (files(a), files(b));
    let names = |files: &BTreeMap<String, Vec<u8>>| files.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&a), names(&b));
    let differ: Vec<_> = a
        .iter()
        .filter(|(name, bytes)| b[*name] != **bytes)
        .map(|f| f.0)
        .collect();
    assert!(differ.is_empty(), "{differ:?} differ");
}

/// Kills a batch of `count` jobs at a random instant and resumes it, `kills` times over; what is
/// left is what an uninterrupted batch leaves.
pub fn survive_kills(directory: &Path, count: usize, kills: u32) {
    write(directory, "jobs.jsonl", &of_all_kinds(count));
    let begun = Instant::now();
    run(directory, "batch jobs.jsonl -o whole -q -t 2", 0);
    let whole = begun.elapsed();
    let mut random = 0x2545_f491_4f6c_dd1d_u64;
    let mut cut = 0;
    for kill in 0..kills {
        random ^= random << 13;
        random ^= random >> 7;
        random ^= random << 17;
        let share = (random >> 11) as f64 / (1u64 << 53) as f64;
        let mut child = start(directory, "batch jobs.jsonl -o cut -q -t 2");
        std::thread::sleep(Duration::from_secs_f64(share * whole.as_secs_f64()));
        child.kill().unwrap();
        let ended = child.wait_with_output().unwrap();
        let before = match directory.join("cut/results.jsonl").exists() {
            true => std::fs::read(directory.join("cut/results.jsonl")).unwrap(),
            false => Vec::new(),
        };
        let lines = before.iter().filter(|byte| **byte == b'\n').count();
        cut += usize::from(!ended.status.success() && lines < count);
        run(directory, "batch jobs.jsonl -o cut -q -t 2 --resume", 0);
        let after = std::fs::read(directory.join("cut/results.jsonl")).unwrap();
        let kept = before
            .iter()
            .rposition(|byte| *byte == b'\n')
            .map_or(0, |at| at + 1);
        assert!(
            after.starts_with(&before[..kept]),
            "kill {kill}: results are not those of before"
        );
        let mut ids: Vec<String> = results(&directory.join("cut"))
            .iter()
            .map(|result| {
                assert_eq!(result["status"], "ok", "kill {kill}: {result}");
                result["id"].as_str().unwrap().to_string()
            })
            .collect();
        assert_eq!(ids.len(), count, "kill {kill}");
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), count, "kill {kill}: a job was done twice");
        assert_same_files(&directory.join("whole"), &directory.join("cut"));
        std::fs::remove_dir_all(directory.join("cut")).unwrap();
    }
    println!("{cut} of {kills} kills came before the end of {whole:?}");
    assert!(
        2 * cut as u32 >= kills,
        "only {cut} of {kills} kills came in time"
    );
}
