//! A folder that was used before: what an earlier run said of it does not stand for a later one.

use crate::workplace::{text, typed, warpath, workplace};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn run(directory: &Path, line: &str, code: i32) {
    let out = warpath(directory, &typed(line));
    assert_eq!(
        out.status.code(),
        Some(code),
        "{line}: {}",
        text(&out.stderr)
    );
}

/// A folder in the place of a file makes the writing of this one fail, and of none before it.
#[test]
fn a_run_that_cannot_write_all_its_files_leaves_no_report_of_an_earlier_one() {
    let directory = workplace();
    let at = directory.path();
    for (line, name) in [
        ("render s.xml", "image.png"),
        ("forward s.xml --param card.translation=1,0,0", "stderr.npy"),
        (
            "backward s.xml --param card.translation --target target.npy",
            "gradients.npz",
        ),
    ] {
        run(at, &format!("{line} -o out"), 0);
        let report = at.join("out/report.json");
        assert!(report.exists(), "{line}");
        std::fs::remove_file(at.join("out").join(name)).unwrap();
        std::fs::create_dir_all(at.join("out").join(name)).unwrap();
        run(at, &format!("{line} --seed 9 -o out"), 4);
        assert!(
            !report.exists(),
            "{line}: the report of the first run is left"
        );
        std::fs::remove_dir_all(at.join("out")).unwrap();
    }
}

/// What has failed before anything was to be written has changed nothing.
#[test]
fn bad_input_leaves_an_earlier_report_alone() {
    let directory = workplace();
    let at = directory.path();
    run(at, "render s.xml -o out", 0);
    run(at, "forward s.xml --param nothing=1 -o out", 3);
    run(
        at,
        "check s.xml --spp 1 --param card.translation=1 -o out",
        3,
    );
    assert!(at.join("out/report.json").exists());
}

#[test]
fn a_check_that_is_killed_leaves_no_verdict_of_an_earlier_one() {
    let directory = workplace();
    let at = directory.path();
    let line = "check s.xml --param env.radiance.value=1,1,1 -q -o out";
    warpath(at, &typed(&format!("{line} --spp 4")));
    let verdicts = ["check.json", "report.json"].map(|name| at.join("out").join(name));
    assert!(verdicts.iter().all(|file| file.exists()));
    let mut child = Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(typed(&format!("{line} --spp 100000 --resolution 512x512")))
        .current_dir(at)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while verdicts.iter().any(|file| file.exists()) && begun.elapsed() < Duration::from_secs(20) {
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    for file in verdicts {
        assert!(!file.exists(), "{} is of the first run", file.display());
    }
}
