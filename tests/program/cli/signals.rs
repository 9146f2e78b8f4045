//! Interrupts: the exit code tells which, and no half-written file is left.

#![cfg(unix)]

use crate::workplace::{text, workplace};
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Stdio};
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
        &["check", "s.xml", "--param", "card.translation=1,0,0", "-q"],
        "INT",
        130,
    );
}

fn start(directory: &Path, arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Signals a child that does not look at signals, and expects it to end soon; what is in its
/// standard output is not read.
fn end_soon(mut child: Child, signal: &str, code: i32) {
    crate::workplace::signal(child.id(), signal);
    let sent = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if sent.elapsed() > Duration::from_secs(20) {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!("{signal} did not end it");
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    let mut stderr = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut stderr).unwrap();
    assert_eq!(status.code(), Some(code), "{stderr}");
    assert!(stderr.ends_with("error: interrupted\n"), "{stderr}");
}

/// A client that asks and asks and does not read the answers: the worker waits for room in the
/// pipe.
#[test]
fn a_worker_whose_answers_nobody_reads_ends() {
    let directory = workplace();
    let results = directory.path().join("out/results.jsonl");
    let mut whole = 0;
    for (signal, code) in [("TERM", 143), ("INT", 130)] {
        let arguments = ["batch", "-", "-o", "out", "-t", "2", "--resume", "-q"];
        let mut child = start(directory.path(), &arguments);
        let mut input = child.stdin.take().unwrap();
        let asking = std::thread::spawn(move || {
            let nothing = "x".repeat(500);
            // Until nobody reads any more.
            while writeln!(input, "{{\"id\":\"a\",\"mode\":\"{nothing}\"}}").is_ok() {}
        });
        let length = || std::fs::metadata(&results).map_or(0, |file| file.len());
        let mut last = (0, Instant::now());
        while last.0 == 0 || last.1.elapsed() < Duration::from_secs(1) {
            if length() != last.0 {
                last = (length(), Instant::now());
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        end_soon(child, signal, code);
        asking.join().unwrap();
        let text = std::fs::read_to_string(&results).unwrap();
        whole += text.lines().count();
        assert!(text.ends_with('\n') && whole > 0, "{text}");
    }
}

#[test]
fn waiting_for_a_pipe_that_never_comes_ends() {
    let directory = workplace();
    let fifo = directory.path().join("jobs");
    let made = Command::new("mkfifo").arg(&fifo).status().unwrap();
    assert!(made.success());
    for (signal, code) in [("TERM", 143), ("INT", 130)] {
        let child = start(directory.path(), &["batch", "jobs", "-o", signal]);
        // The folder is made before the jobs are read.
        while !directory.path().join(signal).exists() {
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis(200));
        end_soon(child, signal, code);
    }
}
