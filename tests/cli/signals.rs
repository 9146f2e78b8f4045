//! Interrupts: the exit code tells which, and no half-written file is left.

#![cfg(unix)]

use crate::workplace::{text, workplace};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Long enough to be interrupted on any machine.
const LONG: [&str; 8] = [
    "--resolution",
    "512x512",
    "--spp",
    "100000",
    "-t",
    "2",
    "-o",
    "long",
];

fn interrupt(directory: &Path, arguments: &[&str], signal: &str, code: i32) {
    let child = Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(arguments)
        .args(LONG)
        .current_dir(directory)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let output = directory.join("long");
    let started = Instant::now();
    // The directory is made when tracing is about to begin.
    while !output.exists() && started.elapsed() < Duration::from_secs(60) {
        std::thread::sleep(Duration::from_millis(10));
    }
    std::thread::sleep(Duration::from_millis(300));
    crate::workplace::signal(child.id(), signal);
    let sent = Instant::now();
    let out = child.wait_with_output().unwrap();
    let what = format!("{signal} during {}", arguments[0]);
    assert_eq!(
        out.status.code(),
        Some(code),
        "{what}: {}",
        text(&out.stderr)
    );
    assert!(sent.elapsed() < Duration::from_secs(20), "{what} took long");
    assert_eq!(text(&out.stderr), "error: interrupted\n", "{what}");
    assert!(out.stdout.is_empty(), "{what}");
    let left: Vec<_> = std::fs::read_dir(&output).unwrap().collect();
    assert!(left.is_empty(), "{what} left {left:?}");
    std::fs::remove_dir(&output).unwrap();
}

#[test]
fn interrupts_stop_every_command_cleanly() {
    let directory = workplace();
    let at = directory.path();
    let forward = ["forward", "s.xml", "--param", "card.translation=1,0,0"];
    interrupt(at, &["render", "s.xml"], "INT", 130);
    interrupt(at, &["render", "s.xml"], "TERM", 143);
    interrupt(at, &forward, "INT", 130);
    interrupt(at, &forward, "TERM", 143);
    crate::workplace::npy(
        at,
        "large.npy",
        "<f4",
        "(512, 512)",
        &crate::workplace::floats(512 * 512, 0.5),
    );
    let backward = [
        "backward",
        "s.xml",
        "--param",
        "card.translation",
        "--target",
        "large.npy",
    ];
    interrupt(at, &backward, "INT", 130);
    interrupt(at, &backward, "TERM", 143);
    interrupt(
        at,
        &["check", "s.xml", "--param", "card.translation=1,0,0"],
        "INT",
        130,
    );
}
