//! A run that was ended at any instant goes on to the same bytes.

use super::{CONFIG, optimize};
use crate::workplace::{signal, workplace};
use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

/// Everything a run writes but the report, which has times.
fn bytes(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut folders = vec![folder.to_path_buf()];
    while let Some(next) = folders.pop() {
        for entry in std::fs::read_dir(next).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            let name = path.strip_prefix(folder).unwrap().display().to_string();
            if name != "report.json" {
                all.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    all
}

pub fn same(a: &Path, b: &Path) {
    let (a, b) = (bytes(a), bytes(b));
    let names = |all: &BTreeMap<String, Vec<u8>>| all.keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&a), names(&b));
    for (name, bytes) in &a {
        assert!(*bytes == b[name], "{name} differs");
    }
}

#[test]
fn one_and_two_threads_give_the_same_bytes() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), CONFIG).unwrap();
    for threads in ["1", "2"] {
        let (code, said) = optimize(at, "c.toml", &["-o", threads, "-t", threads, "--quiet"]);
        assert_eq!(code, Some(0), "{said}");
    }
    same(&at.join("1"), &at.join("2"));
}

#[test]
fn shares_are_the_same_samples_for_any_number_of_threads() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), CONFIG).unwrap();
    for threads in ["1", "2"] {
        let arguments = [
            "-o",
            threads,
            "-t",
            threads,
            "--quiet",
            "--set",
            "render.shares=4",
        ];
        assert_eq!(optimize(at, "c.toml", &arguments).0, Some(0));
    }
    same(&at.join("1"), &at.join("2"));
}

#[test]
fn killed_runs_go_on_to_the_same_bytes() {
    let directory = workplace();
    let at = directory.path();
    let long = CONFIG
        .replace("steps = 6", "steps = 60")
        .replace("spp = 8\n", "spp = 16\n");
    std::fs::write(at.join("c.toml"), long).unwrap();
    assert_eq!(
        optimize(at, "c.toml", &["-o", "whole", "--quiet"]).0,
        Some(0)
    );
    // KILL leaves what the last checkpoint has, TERM and INT what is done.
    let mut ended = Vec::new();
    for (milliseconds, name) in [(60, "KILL"), (150, "TERM"), (100, "KILL"), (120, "INT")] {
        let resumes = at.join("parts/checkpoint.bin").exists();
        let mut command = Command::new(env!("CARGO_BIN_EXE_warpath"));
        command.args(["optimize", "c.toml", "-o", "parts", "--quiet"]);
        if resumes {
            command.arg("--resume");
        }
        let mut child = command
            .current_dir(at)
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        std::thread::sleep(Duration::from_millis(milliseconds));
        if child.try_wait().unwrap().is_none() {
            signal(child.id(), name);
        }
        ended.push(child.wait().unwrap().code());
    }
    let last = match at.join("parts/checkpoint.bin").exists() {
        true => optimize(at, "c.toml", &["-o", "parts", "--quiet", "--resume"]),
        false => optimize(at, "c.toml", &["-o", "parts", "--quiet"]),
    };
    assert_eq!(last.0, Some(0), "{ended:?} {}", last.1);
    same(&at.join("whole"), &at.join("parts"));
    for code in ended {
        assert!(matches!(code, None | Some(0 | 130 | 143)), "{code:?}");
    }
}

#[test]
fn a_checkpoint_is_neither_overwritten_nor_mistaken() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), CONFIG).unwrap();
    let run = |arguments: &[&str]| optimize(at, "c.toml", arguments);
    assert_eq!(run(&["-o", "a", "--quiet"]).0, Some(0));
    let (code, said) = run(&["-o", "a"]);
    assert!(
        code == Some(2) && said.contains("--resume goes on with it"),
        "{said}"
    );
    let (code, said) = run(&["-o", "a", "--resume", "--set", "optimizer.lr=1"]);
    assert!(
        code == Some(2) && said.contains("of another configuration or --set"),
        "{said}"
    );
    assert_eq!(run(&["-o", "a", "--fresh", "--quiet"]).0, Some(0));
    let path = at.join("a/checkpoint.bin");
    let mut bytes = std::fs::read(&path).unwrap();
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    std::fs::write(&path, bytes).unwrap();
    let (code, said) = run(&["-o", "a", "--resume"]);
    assert!(
        code == Some(3) && said.contains("not a whole checkpoint"),
        "{said}"
    );
}

/// Killed runs of their own, each at another instant: while the scene loads, within steps, while a
/// checkpoint or the results are written.
#[cfg(feature = "long-tests")]
#[test]
fn runs_killed_at_every_part_of_their_time_go_on_to_the_same_bytes() {
    const INSTANTS: u32 = 40;
    let directory = workplace();
    let at = directory.path();
    let long = CONFIG.replace("steps = 6", "steps = 40");
    std::fs::write(at.join("c.toml"), long).unwrap();
    let begun = std::time::Instant::now();
    let (code, said) = optimize(at, "c.toml", &["-o", "whole", "--quiet"]);
    assert_eq!(code, Some(0), "{said}");
    let whole = begun.elapsed();
    let mut killed = 0;
    for i in 0..INSTANTS {
        let folder = format!("killed-{i}");
        let mut child = Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(["optimize", "c.toml", "-o", &folder, "--quiet"])
            .current_dir(at)
            .spawn()
            .unwrap();
        std::thread::sleep(whole * (2 * i + 1) / (2 * INSTANTS));
        if child.try_wait().unwrap().is_none() {
            signal(child.id(), "KILL");
        }
        killed += u32::from(child.wait().unwrap().code().is_none());
        let mut arguments = vec!["-o", &folder, "--quiet"];
        if at.join(&folder).join("checkpoint.bin").exists() {
            arguments.push("--resume");
        }
        let (code, said) = optimize(at, "c.toml", &arguments);
        assert_eq!(code, Some(0), "{i}: {said}");
        same(&at.join("whole"), &at.join(&folder));
    }
    assert!(killed > INSTANTS / 2, "{killed}");
}
