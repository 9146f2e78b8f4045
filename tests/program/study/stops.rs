//! Stopped at any instant, a study goes on; and it finds the same twice.

use super::write_config;
use crate::workplace::{text, typed, warpath, workplace};
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// The results but for times.
fn without_times(path: &Path) -> String {
    let text = std::fs::read_to_string(path.join("study.json")).unwrap();
    let mut all: Value = serde_json::from_str(&text).unwrap();
    for row in all["rows"].as_array_mut().unwrap() {
        for cell in row["cells"].as_array_mut().unwrap() {
            cell.as_object_mut().unwrap().remove("times").unwrap();
        }
    }
    all.to_string()
}

fn gradients(path: &Path) -> Vec<(String, Vec<u8>)> {
    let folder = std::fs::read_dir(path.join("gradients")).unwrap();
    let mut files: Vec<_> = folder.map(|entry| entry.unwrap().path()).collect();
    files.sort();
    let name = |path: &Path| path.file_name().unwrap().to_string_lossy().into_owned();
    files
        .iter()
        .map(|path| (name(path), std::fs::read(path).unwrap()))
        .collect()
}

#[test]
fn killed_studies_go_on_and_end_with_the_same_bytes() {
    let directory = workplace();
    let at = directory.path();
    write_config(at);
    let whole = warpath(at, &typed("study c.toml -o whole --threads 1 -q"));
    assert_eq!(whole.status.code(), Some(0), "{}", text(&whole.stderr));
    // As a process leaves it that is killed while it writes.
    std::fs::create_dir_all(at.join("killed/gradients")).unwrap();
    std::fs::write(at.join("killed/gradients/.a.npy.4711.tmp"), "half").unwrap();
    let mut finished = false;
    for kill in 0..60u64 {
        let mut command = Command::new(env!("CARGO_BIN_EXE_warpath"));
        let command = command.args(typed("study c.toml -o killed --resume -q --threads 2"));
        let mut child = command
            .current_dir(at)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(30 + 60 * kill));
        if let Some(status) = child.try_wait().unwrap() {
            assert_eq!(status.code(), Some(0));
            finished = true;
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    assert!(finished, "it was killed every time");
    assert_eq!(
        without_times(&at.join("killed")),
        without_times(&at.join("whole"))
    );
    assert_eq!(gradients(&at.join("killed")), gradients(&at.join("whole")));
    // What is there is not written over by chance, and a torn line is measured again.
    let again = warpath(at, &typed("study c.toml -o whole"));
    assert_eq!(again.status.code(), Some(2), "{}", text(&again.stderr));
    let journal = at.join("whole/study.jsonl");
    let lines = std::fs::read(&journal).unwrap();
    std::fs::write(&journal, &lines[..lines.len() - 9]).unwrap();
    let before = without_times(&at.join("whole"));
    let resumed = warpath(at, &typed("study c.toml -o whole --resume"));
    assert_eq!(resumed.status.code(), Some(0), "{}", text(&resumed.stderr));
    assert!(
        text(&resumed.stderr).contains("of 2: card"),
        "{}",
        text(&resumed.stderr)
    );
    assert_eq!(without_times(&at.join("whole")), before);
}

#[test]
fn a_journal_that_cannot_be_read_is_left_alone() {
    let directory = workplace();
    let at = directory.path();
    write_config(at);
    let line = "study c.toml -o out -q --set repeats=2 --set reference.runs=2 --set methods=[\"interior\"]";
    let run = |more: &str| {
        let out = warpath(at, &typed(&format!("{line} {more}")));
        (out.status.code(), text(&out.stderr))
    };
    assert_eq!(run(""), (Some(0), String::new()));
    let journal = at.join("out/study.jsonl");
    let good = std::fs::read(&journal).unwrap();
    let first = good.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    let mut not_utf8 = good.clone();
    not_utf8[first + 20] = 0xff;
    let rubbish = [&good[..first], b"rubbish\n", &good[first..]].concat();
    for bad in [not_utf8, rubbish] {
        std::fs::write(&journal, &bad).unwrap();
        let (code, message) = run("--resume");
        assert_eq!(code, Some(3), "{message}");
        assert!(
            message.contains("out/study.jsonl:2: not a line"),
            "{message}"
        );
        assert_eq!(run("").0, Some(2));
        assert_eq!(std::fs::read(&journal).unwrap(), bad);
    }
    // Nor is something else under its name.
    std::fs::remove_file(&journal).unwrap();
    std::fs::create_dir(&journal).unwrap();
    for more in ["", "--resume"] {
        let (code, message) = run(more);
        assert_eq!(code, Some(3), "{message}");
        assert!(
            message.contains("out/study.jsonl: Is a directory"),
            "{message}"
        );
    }
}

#[test]
fn a_signal_stops_it_cleanly() {
    let directory = workplace();
    let at = directory.path();
    write_config(at);
    let mut command = Command::new(env!("CARGO_BIN_EXE_warpath"));
    let command = command.args(typed(
        "study c.toml -o out --set reference.spp=4096 --log-format json",
    ));
    let child = command
        .current_dir(at)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    crate::workplace::signal(child.id(), "TERM");
    let out = child.wait_with_output().unwrap();
    assert_eq!(out.status.code(), Some(143), "{}", text(&out.stderr));
    assert!(
        text(&out.stderr).contains("\"seconds_left\""),
        "{}",
        text(&out.stderr)
    );
}

/// A reference that another build of the program made is made again: what it computes may differ.
#[test]
fn another_program_makes_its_own_references() {
    let directory = workplace();
    let at = directory.path();
    write_config(at);
    let count = || std::fs::read_dir(at.join("shared")).unwrap().count();
    let study = |program: &Path, out: &str| {
        let line = format!("study c.toml -o {out} --references shared -q");
        let mut command = Command::new(program);
        let ended = command.args(typed(&line)).current_dir(at).output().unwrap();
        assert_eq!(ended.status.code(), Some(0), "{}", text(&ended.stderr));
    };
    let program = Path::new(env!("CARGO_BIN_EXE_warpath"));
    study(program, "first");
    let made = count();
    study(program, "second");
    assert_eq!(count(), made);
    // A byte after the end of a program changes nothing of what it does.
    let other = at.join("other");
    std::fs::copy(program, &other).unwrap();
    let mut file = std::fs::OpenOptions::new()
        .append(true)
        .open(&other)
        .unwrap();
    std::io::Write::write_all(&mut file, &[0]).unwrap();
    drop(file);
    study(&other, "third");
    assert_eq!(count(), 2 * made);
}
