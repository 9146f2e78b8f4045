//! Going on where an earlier run stopped.

use crate::jobs::{assert_same_files, files, of_all_kinds, results, run, start, write};
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
    std::fs::write(at.join("parts/.batch.json.4711.tmp"), "half").unwrap();
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

#[test]
fn a_scene_that_has_changed_is_told_once() {
    let directory = workplace();
    let at = directory.path();
    let jobs: Vec<_> = (0..4)
        .map(|i| json!({"id": format!("job-{i}"), "mode": "render", "scene": "s.xml"}))
        .collect();
    write(at, "jobs.jsonl", &jobs[..1]);
    run(at, "batch jobs.jsonl -o out", 0);
    write(at, "jobs.jsonl", &jobs[..2]);
    let same = run(at, "batch jobs.jsonl -o out --resume", 0);
    assert!(!String::from_utf8_lossy(&same.stderr).contains("has changed"));
    let scene = std::fs::read_to_string(at.join("s.xml")).unwrap();
    let other = scene.replace("0.2, 0.5, 0.1", "0.2, 0.75, 0.1");
    std::fs::write(at.join("s.xml"), other).unwrap();
    write(at, "jobs.jsonl", &jobs);
    let changed = run(at, "batch jobs.jsonl -o out --resume", 0);
    let message = String::from_utf8_lossy(&changed.stderr);
    let said = "s.xml has changed since an earlier run did jobs of it";
    assert_eq!(message.matches(said).count(), 1, "{message}");
    let warned = results(&at.join("out")).into_iter().map(|line| {
        let warning = line["warnings"][0].as_str().unwrap_or_default().to_string();
        warning.contains(said)
    });
    assert_eq!(warned.collect::<Vec<_>>(), [false, false, true, true]);
}

/// What the folder holds, with what symbolic links in it lead to.
fn snapshot(directory: &std::path::Path) -> Vec<(String, Vec<u8>)> {
    let mut all = files(directory);
    for own in ["results.jsonl", "batch.json", "report.json"] {
        let text = std::fs::read(directory.join(own)).unwrap_or_default();
        all.insert(own.into(), text);
    }
    all.into_iter().collect()
}

#[test]
fn a_result_that_was_damaged_is_told_before_anything_changes() {
    let directory = workplace();
    let at = directory.path();
    let mut jobs = of_all_kinds(3);
    jobs[2]["spp"] = json!(0);
    write(at, "jobs.jsonl", &jobs);
    run(at, "batch jobs.jsonl -o out -t 1", 5);
    let path = at.join("out/results.jsonl");
    let text = std::fs::read_to_string(&path).unwrap();
    let id = text.find("\"id\":\"job-1\",").unwrap();
    let line = text[..id].lines().count();
    std::fs::write(&path, text.replace("\"id\":\"job-1\",", "")).unwrap();
    std::fs::create_dir(at.join("out/.job-9.unfinished")).unwrap();
    std::fs::write(at.join("out/.job-9.unfinished/half"), "half").unwrap();
    let before = snapshot(&at.join("out"));
    let out = run(at, "batch jobs.jsonl -o out --resume", 3);
    let message = String::from_utf8_lossy(&out.stderr);
    let place = format!("out/results.jsonl:{line}: ");
    assert!(message.contains(&place), "{message}");
    assert!(message.contains("missing field `id`"), "{message}");
    assert_eq!(before, snapshot(&at.join("out")));
    // Nor is anything changed when a job is another than before.
    std::fs::write(&path, &text).unwrap();
    jobs[0]["seed"] = json!(77);
    write(at, "jobs.jsonl", &jobs);
    let before = snapshot(&at.join("out"));
    run(at, "batch jobs.jsonl -o out --resume", 2);
    assert_eq!(before, snapshot(&at.join("out")));
}

#[test]
#[cfg(unix)]
fn symbolic_links_lead_no_results_elsewhere() {
    use std::os::unix::fs::symlink;
    let directory = workplace();
    let at = directory.path();
    let jobs = of_all_kinds(2);
    write(at, "jobs.jsonl", &jobs);
    std::fs::create_dir(at.join("elsewhere")).unwrap();
    std::fs::write(at.join("elsewhere/file"), "").unwrap();
    let temporary = [".results.jsonl.4711.tmp", ".job-0.unfinished"];
    for name in ["results.jsonl", "batch.json", "report.json"]
        .into_iter()
        .chain(temporary)
    {
        for target in ["elsewhere/file", "elsewhere/none", "elsewhere"] {
            let out = at.join("out");
            std::fs::create_dir(&out).unwrap();
            symlink(at.join(target), out.join(name)).unwrap();
            for resume in ["", "--resume"] {
                let line = format!("batch jobs.jsonl -o out {resume}");
                let ended = run(at, &line, 3);
                let message = String::from_utf8_lossy(&ended.stderr);
                let says = format!("out/{name}: a symbolic link");
                assert!(message.contains(&says), "{message}");
            }
            let left: Vec<_> = std::fs::read_dir(&out).unwrap().collect();
            assert_eq!(left.len(), 1, "{name}: {left:?}");
            std::fs::remove_dir_all(&out).unwrap();
        }
    }
    // A job's folder is in the way of that job alone.
    std::fs::create_dir(at.join("out")).unwrap();
    symlink(at.join("elsewhere"), at.join("out/job-0")).unwrap();
    run(at, "batch jobs.jsonl -o out", 5);
    let lines = results(&at.join("out"));
    let linked = lines.iter().find(|line| line["id"] == "job-0").unwrap();
    assert_eq!(linked["code"], 3, "{linked}");
    assert!(at.join("out/job-0").is_symlink());
    assert_eq!(files(&at.join("elsewhere")).len(), 1);
    assert_eq!(std::fs::read(at.join("elsewhere/file")).unwrap(), b"");
}

#[test]
#[cfg(unix)]
fn an_interrupted_batch_keeps_what_is_finished() {
    let directory = workplace();
    let at = directory.path();
    let mut jobs = of_all_kinds(3);
    jobs[2]["spp"] = json!(1_000_000);
    write(at, "jobs.jsonl", &jobs);
    for (signal, code) in [("INT", 130), ("TERM", 143)] {
        let output = at.join(signal);
        let child = start(at, &format!("batch jobs.jsonl -o {signal} -t 2"));
        let has_two = || {
            let text = std::fs::read_to_string(output.join("results.jsonl"));
            text.is_ok_and(|text| text.lines().count() == 2)
        };
        while !has_two() {
            std::thread::sleep(std::time::Duration::from_millis(10));
        }
        crate::workplace::signal(child.id(), signal);
        let out = child.wait_with_output().unwrap();
        let message = String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(code), "{message}");
        assert!(message.ends_with("error: interrupted\n"), "{message}");
        let folders: Vec<String> = files(&output).into_keys().collect();
        assert!(
            folders
                .iter()
                .all(|f| f.starts_with("job-0/") || f.starts_with("job-1/")),
            "{folders:?}"
        );
    }
}

#[test]
fn progress_is_told_as_events() {
    let directory = workplace();
    let at = directory.path();
    let mut jobs = of_all_kinds(3);
    jobs[1]["spp"] = json!(0);
    write(at, "jobs.jsonl", &jobs);
    let out = run(at, "batch jobs.jsonl -o out --log-format json --json", 5);
    let lines = String::from_utf8(out.stderr).unwrap();
    let events: Vec<serde_json::Value> = lines
        .lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect();
    let progress = events.iter().rfind(|e| e["event"] == "progress").unwrap();
    assert_eq!(
        (&progress["done"], &progress["failed"], &progress["total"]),
        (&json!(3), &json!(1), &json!(3))
    );
    assert!(
        progress["jobs_per_second"].as_f64() > Some(0.0)
            && progress["rays_per_second"].as_f64() > Some(0.0)
    );
    assert_eq!(progress["seconds_left"], 0.0);
    let report: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let summary = &report["summary"];
    assert_eq!(
        (&summary["jobs"], &summary["failed"]),
        (&json!(3), &json!(1))
    );
    assert_eq!(summary["slowest"].as_array().unwrap().len(), 2);
    assert_eq!(summary["failures"][0]["code"], 3);
    let written = std::fs::read(at.join("out/report.json")).unwrap();
    assert_eq!(out.stdout, written);
}
