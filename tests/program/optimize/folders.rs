//! The folder of a run: one run at a time, nothing of an earlier one, and a page while it goes on.

use super::{CONFIG, optimize};
use crate::workplace::{signal, workplace};
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// Steps of which there are more than anybody waits for.
fn endless() -> String {
    CONFIG.replace("steps = 6", "steps = 1000000")
}

/// Steps that take longer than anybody waits.
fn slow() -> String {
    CONFIG.replace(
        "spp = 8\n",
        "spp = 8\nloss_spp = 100000\nresolution = [256, 256]\n",
    )
}

/// A run that is killed when the test ends, however it ends.
struct Running(Child);

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

impl Running {
    fn start(at: &Path, config: &str, arguments: &[&str]) -> Self {
        let child = Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(["optimize", config, "-o", "out", "-q", "-t", "1"])
            .args(arguments)
            .current_dir(at)
            .stdin(Stdio::null())
            .stderr(Stdio::piped())
            .spawn();
        Self(child.unwrap())
    }

    /// The exit code and the message, if it ends by itself.
    fn end(mut self) -> (Option<i32>, String) {
        assert!(comes(|| self.0.try_wait().unwrap().is_some()), "it goes on");
        let mut said = String::new();
        self.0
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut said)
            .unwrap();
        (self.0.wait().unwrap().code(), said)
    }
}

/// Whether something came about within half a minute.
fn comes(mut about: impl FnMut() -> bool) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(30) {
        if about() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    false
}

#[test]
fn two_runs_do_not_write_into_one_folder() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), endless()).unwrap();
    let first = Running::start(at, "c.toml", &[]);
    assert!(comes(|| at.join("out/checkpoint.bin").exists()));
    let others = ["--resume", "--fresh"].map(|how| Running::start(at, "c.toml", &[how]).end());
    drop(first);
    for (code, said) in others {
        assert!(
            code == Some(4) && said.contains("out: another run is writing there"),
            "{code:?} {said}"
        );
    }
    // A lock ends with whoever held it.
    let (code, said) = Running::start(at, "c.toml", &["--fresh", "--set", "steps=2"]).end();
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn a_fresh_run_begins_without_the_files_of_the_one_before() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), CONFIG).unwrap();
    std::fs::write(at.join("slow.toml"), slow()).unwrap();
    let (code, said) = optimize(at, "c.toml", &["-o", "out", "-q"]);
    assert_eq!(code, Some(0), "{said}");
    // One of each kind: what a run that was killed has left of a view, and what users put there.
    let others = ["mesh-mine.ply", "notes.txt", "scene", "view-of-mine.png"];
    std::fs::write(at.join("out/view-7_other.png"), "of a run that was killed").unwrap();
    for name in [
        "mesh-mine.ply",
        "notes.txt",
        "view-of-mine.png",
        "scene/mine.ply",
    ] {
        std::fs::write(at.join("out").join(name), "mine").unwrap();
    }
    let second = Running::start(at, "slow.toml", &["--fresh"]);
    let names = |folder: &str| {
        let entries = std::fs::read_dir(at.join(folder)).unwrap();
        let names = entries.map(|e| e.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let is_clear = comes(|| names("out") == others);
    drop(second);
    assert!(is_clear, "{:?}", names("out"));
    assert_eq!(names("out/scene"), ["mine.ply"]);
}

#[test]
fn a_run_that_goes_on_has_no_report_until_it_ends() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), endless()).unwrap();
    let first = Running::start(at, "c.toml", &[]);
    assert!(comes(|| at.join("out/checkpoint.bin").exists()));
    drop(first);
    std::fs::write(at.join("out/report.json"), "of a run before").unwrap();
    let second = Running::start(at, "c.toml", &["--resume"]);
    let is_gone = comes(|| !at.join("out/report.json").exists());
    drop(second);
    assert!(is_gone);
}

#[test]
fn the_page_shows_a_run_that_goes_on() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), endless()).unwrap();
    let running = Running::start(at, "c.toml", &[]);
    let page = || std::fs::read_to_string(at.join("out/index.html")).unwrap_or_default();
    let comes_up = comes(|| page().ends_with("</html>\n"));
    let first = page();
    let goes_on = comes(|| page() != first);
    assert!(at.join("out/loss.csv").exists());
    signal(running.0.id(), "TERM");
    let (code, said) = running.end();
    assert_eq!(code, Some(143), "{said}");
    assert!(comes_up && first.contains("running; this page looks again by itself"));
    assert!(first.contains("data:image/png;base64,"));
    assert!(goes_on);
    let last = page();
    assert!(
        last.contains("interrupted") && !last.contains("refresh"),
        "{last}"
    );
}

#[test]
fn a_run_that_may_go_on_begins_where_there_is_nothing() {
    let directory = workplace();
    let at = directory.path();
    std::fs::write(at.join("c.toml"), CONFIG).unwrap();
    for folder in ["whole", "again"] {
        let (code, said) = optimize(at, "c.toml", &["-o", folder, "-q", "--resume"]);
        assert_eq!(code, Some(0), "{said}");
    }
    super::resume::same(&at.join("whole"), &at.join("again"));
}
