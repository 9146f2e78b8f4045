//! Several processes of one run, by `mpirun`: a build with the feature `mpi`, and one without.

use super::CONFIG;
use crate::workplace::{text, workplace};
use std::path::Path;
use std::process::{Command, Stdio};

/// The program with what a launcher would tell it.
fn told(at: &Path, variable: &str, processes: &str) -> (Option<i32>, String) {
    std::fs::write(at.join("c.toml"), CONFIG).unwrap();
    let out = Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(["optimize", "c.toml", "-o", "out", "--quiet"])
        .env(variable, processes)
        .current_dir(at)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    (out.status.code(), text(&out.stderr))
}

#[test]
fn one_process_is_no_launch() {
    for variable in ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "SLURM_STEP_NUM_TASKS"] {
        let directory = workplace();
        let (code, said) = told(directory.path(), variable, "1");
        assert_eq!(code, Some(0), "{said}");
    }
    // The script of sbatch runs once for all its tasks.
    let directory = workplace();
    let (code, said) = told(directory.path(), "SLURM_NTASKS", "4");
    assert_eq!(code, Some(0), "{said}");
}

#[cfg(not(feature = "mpi"))]
#[test]
fn several_processes_need_mpi() {
    let launchers = [
        ("OMPI_COMM_WORLD_SIZE", "mpirun"),
        ("PMI_SIZE", "mpiexec"),
        ("SLURM_STEP_NUM_TASKS", "srun"),
    ];
    for (variable, launcher) in launchers {
        let directory = workplace();
        let (code, said) = told(directory.path(), variable, "3");
        assert_eq!(code, Some(2), "{said}");
        let wanted = format!("{launcher} has started 3 processes");
        assert!(
            said.contains(&wanted) && said.contains("--features mpi"),
            "{said}"
        );
        assert!(!directory.path().join("out").exists());
    }
}

#[cfg(feature = "mpi")]
mod by_mpirun {
    use super::*;
    use crate::optimize::optimize;
    use crate::optimize::resume::same;
    use crate::workplace::signal;
    use std::os::unix::process::CommandExt;
    use std::process::Child;
    use std::time::{Duration, Instant};
    use tempfile::{NamedTempFile, TempDir};

    /// More units than processes, and no multiple of three.
    const SHARES: &str = "render.shares=4";

    /// What takes a second on an idle machine has not hung before this.
    const LONGEST: Duration = Duration::from_secs(120);

    /// An `mpirun` with what it has started: one group of processes, which ends with this. They
    /// write to files: a process that outlives `mpirun` would hold a pipe open for ever.
    struct Run {
        child: Child,
        said: NamedTempFile,
        _session: TempDir,
    }

    impl Run {
        fn start(mut command: Command) -> Self {
            let said = NamedTempFile::new().unwrap();
            // Open MPI has one folder for all that a user runs at a time: two that begin together
            // may both try to make it, and the one that ends first takes it away.
            let session = tempfile::tempdir().unwrap();
            let child = command
                .env("TMPDIR", session.path())
                .process_group(0)
                .stdin(Stdio::null())
                .stdout(Stdio::null())
                .stderr(said.reopen().unwrap())
                .spawn()
                .unwrap();
            Self {
                child,
                said,
                _session: session,
            }
        }

        fn said(&self) -> String {
            std::fs::read_to_string(self.said.path()).unwrap()
        }

        /// Waits until something is there, which has to come before it ends.
        fn wait_for(&mut self, file: &Path) {
            let started = Instant::now();
            while !file.exists() {
                assert!(
                    started.elapsed() < LONGEST,
                    "{file:?} not after {LONGEST:?}: {}",
                    self.state()
                );
                let ended = self.child.try_wait().unwrap();
                assert!(
                    ended.is_none(),
                    "{ended:?} before {file:?}: {}",
                    self.said()
                );
                std::thread::sleep(Duration::from_millis(5));
            }
        }

        /// Its exit code and what it said, once it has ended.
        fn end(mut self) -> (Option<i32>, String) {
            let started = Instant::now();
            loop {
                if let Some(status) = self.child.try_wait().unwrap() {
                    return (status.code(), self.said());
                }
                assert!(
                    started.elapsed() < LONGEST,
                    "hung for {LONGEST:?}: {}",
                    self.state()
                );
                std::thread::sleep(Duration::from_millis(5));
            }
        }

        /// What its processes do and have said, for whoever has to find out why they hang.
        fn state(&self) -> String {
            let mut text = format!("it said {:?}\n", self.said());
            for process in std::iter::once(self.child.id()).chain(children(self.child.id())) {
                for file in ["status", "wchan", "syscall"] {
                    let read = std::fs::read_to_string(format!("/proc/{process}/{file}"));
                    let lines = read.unwrap_or_default();
                    let telling = |l: &&str| {
                        file != "status" || l.starts_with("State") || l.starts_with("Sig")
                    };
                    let lines: Vec<&str> = lines.lines().filter(telling).collect();
                    text += &format!("{process} {file}: {}\n", lines.join("; "));
                }
            }
            text
        }
    }

    impl Drop for Run {
        fn drop(&mut self) {
            if self.child.try_wait().is_ok_and(|ended| ended.is_none()) {
                signal_group(self.child.id());
                let _ = self.child.wait();
            }
        }
    }

    /// Ends a group of processes at once.
    fn signal_group(leader: u32) {
        let line = format!("kill -KILL -{leader}");
        let _ = Command::new("sh").args(["-c", &line]).status();
    }

    /// What an `mpirun` has started, by whichever of its threads.
    fn children(mpirun: u32) -> Vec<u32> {
        let threads = std::fs::read_dir(format!("/proc/{mpirun}/task")).unwrap();
        let children: String = threads
            .map(|thread| std::fs::read_to_string(thread.unwrap().path().join("children")).unwrap())
            .collect();
        children
            .split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect()
    }

    fn command(at: &Path, ranks: u32, arguments: &[&str]) -> Command {
        let mut command = Command::new("mpirun");
        let count = ranks.to_string();
        command
            .args(["--allow-run-as-root", "--oversubscribe", "-n", &count])
            // Processes that wait leave the cores to those of other tests.
            .args(["--bind-to", "none", "--mca", "mpi_yield_when_idle", "1"])
            .args([
                env!("CARGO_BIN_EXE_warpath"),
                "optimize",
                "c.toml",
                "-t",
                "1",
            ])
            .args(["--set", SHARES])
            .args(arguments)
            .current_dir(at);
        command
    }

    fn mpirun(at: &Path, ranks: u32, arguments: &[&str]) -> (Option<i32>, String) {
        Run::start(command(at, ranks, arguments)).end()
    }

    #[test]
    fn any_number_of_processes_writes_the_same_bytes() {
        let directory = workplace();
        let at = directory.path();
        std::fs::write(at.join("c.toml"), CONFIG).unwrap();
        let (code, said) = optimize(at, "c.toml", &["-o", "alone", "-q", "--set", SHARES]);
        assert_eq!(code, Some(0), "{said}");
        for ranks in [1, 2, 3] {
            let folder = ranks.to_string();
            let (code, said) = mpirun(at, ranks, &["-o", &folder]);
            assert_eq!(code, Some(0), "{said}");
            assert_eq!(said.matches("6 steps: the loss went").count(), 1, "{said}");
            same(&at.join("alone"), &at.join(&folder));
            let report = std::fs::read(at.join(&folder).join("report.json")).unwrap();
            let report: serde_json::Value = serde_json::from_slice(&report).unwrap();
            assert_eq!(report["processes"], ranks);
        }
    }

    #[test]
    fn a_killed_process_ends_the_run_and_resume_goes_on() {
        let directory = workplace();
        let at = directory.path();
        let long = CONFIG.replace("steps = 6", "steps = 12");
        std::fs::write(at.join("c.toml"), long).unwrap();
        let (code, said) = optimize(at, "c.toml", &["-o", "whole", "-q", "--set", SHARES]);
        assert_eq!(code, Some(0), "{said}");
        for killed in [0, 1] {
            let folder = format!("killed-{killed}");
            let mut run = Run::start(command(at, 2, &["-o", &folder, "-q"]));
            run.wait_for(&at.join(&folder).join("checkpoint.bin"));
            signal(process_of(run.child.id(), killed), "KILL");
            let (code, said) = run.end();
            assert!(
                code != Some(0) && said.contains("signal 9"),
                "{code:?} {said}"
            );
            let (code, said) = mpirun(at, 3, &["-o", &folder, "-q", "--resume"]);
            assert_eq!(code, Some(0), "{said}");
            same(&at.join("whole"), &at.join(&folder));
        }
    }

    /// The process of a rank that an `mpirun` has started.
    fn process_of(mpirun: u32, rank: u32) -> u32 {
        let mut numbers = children(mpirun).into_iter();
        let wanted = format!("OMPI_COMM_WORLD_RANK={rank}\0");
        let is_it = |process: &u32| {
            let environment = std::fs::read(format!("/proc/{process}/environ")).unwrap();
            String::from_utf8_lossy(&environment).contains(&wanted)
        };
        numbers.find(is_it).expect("a process of this rank")
    }

    #[test]
    fn one_process_says_why_all_end() {
        let directory = workplace();
        let at = directory.path();
        let table = [
            (CONFIG.replace("s.xml", "nowhere.xml"), 3, "nowhere.xml"),
            (CONFIG.replace("steps = 6", "steps = six"), 3, "c.toml:2:9"),
            (CONFIG.replace("card.tr", "cart.tr"), 3, "card.translation"),
        ];
        for (config, code, part) in table {
            std::fs::write(at.join("c.toml"), config).unwrap();
            let (found, said) = mpirun(at, 3, &["-o", "bad"]);
            assert_eq!(found, Some(code), "{said}");
            assert_eq!(said.matches("error: ").count(), 1, "{said}");
            assert!(said.contains(part), "{said}");
        }
    }

    #[test]
    fn a_process_that_fails_alone_is_heard() {
        let directory = workplace();
        let at = directory.path();
        std::fs::write(at.join("c.toml"), CONFIG).unwrap();
        // The second process finds another scene than the first.
        let scene = std::fs::read_to_string(at.join("s.xml")).unwrap();
        for (name, text) in [
            ("other", scene.replace("0.2, 0.5, 0.1", "0.2, 0.6, 0.1")),
            ("broken", scene.replace("<sensor", "<sensors")),
        ] {
            let elsewhere = at.join(name);
            std::fs::create_dir(&elsewhere).unwrap();
            std::fs::write(elsewhere.join("s.xml"), text).unwrap();
            std::fs::write(elsewhere.join("c.toml"), CONFIG).unwrap();
        }
        for (name, code, part) in [
            (
                "other",
                4,
                "processes 0 and 1 of 2 have come to other numbers",
            ),
            ("broken", 3, "process 1 of 2: "),
        ] {
            let line = format!(
                "mpirun --allow-run-as-root --oversubscribe -n 1 {0} optimize c.toml -t 1 -o {1}/out \
                 : -n 1 -wdir {1} {0} optimize c.toml -t 1 -o {1}/out",
                env!("CARGO_BIN_EXE_warpath"),
                at.join(name).display(),
            );
            let mut shell = Command::new("sh");
            shell.args(["-c", &format!("exec {line}")]).current_dir(at);
            let (found, said) = Run::start(shell).end();
            assert_eq!(found, Some(code), "{said}");
            assert!(said.contains(part), "{said}");
        }
    }

    #[test]
    fn interrupted_runs_go_on() {
        let directory = workplace();
        let at = directory.path();
        let long = CONFIG.replace("steps = 6", "steps = 12");
        std::fs::write(at.join("c.toml"), long).unwrap();
        let (code, said) = optimize(at, "c.toml", &["-o", "whole", "-q", "--set", SHARES]);
        assert_eq!(code, Some(0), "{said}");
        let mut run = Run::start(command(at, 2, &["-o", "parts", "-q"]));
        run.wait_for(&at.join("parts/checkpoint.bin"));
        // One process alone gets it: all must end.
        signal(process_of(run.child.id(), 1), "TERM");
        // Between two steps it says which signal it was, within one only that it was interrupted.
        let (code, said) = run.end();
        assert!(matches!(code, Some(130 | 143)), "{code:?} {said}");
        let (code, said) = mpirun(at, 2, &["-o", "parts", "-q", "--resume"]);
        assert_eq!(code, Some(0), "{said}");
        same(&at.join("whole"), &at.join("parts"));
    }

    #[test]
    fn processes_that_mpi_does_not_connect_are_refused() {
        let directory = workplace();
        let (code, said) = told(directory.path(), "SLURM_STEP_NUM_TASKS", "2");
        assert_eq!(code, Some(2), "{said}");
        assert!(said.contains("that MPI does not connect"), "{said}");
    }
}
