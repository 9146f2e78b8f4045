//! The recipes of docs/scaling.md with the real programs, where they are installed: GNU parallel,
//! Open MPI, Slurm.

use crate::jobs::{assert_same_files, of_all_kinds, run, write};
use crate::workplace::workplace;
use std::path::Path;
use std::process::{Command, Stdio};

/// Runs a line of shell in which `warpath` is the program under test.
fn shell(at: &Path, line: &str) {
    let program = Path::new(env!("CARGO_BIN_EXE_warpath")).parent().unwrap();
    let path = std::env::var("PATH").unwrap();
    let out = Command::new("bash")
        .args(["-ec", line])
        .env("PATH", format!("{}:{path}", program.display()))
        .current_dir(at)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let said =
        String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    assert!(out.status.success(), "{line}: {said}");
}

fn is_installed(program: &str) -> bool {
    let found = Command::new("bash")
        .args(["-c", &format!("command -v {program}")])
        .output();
    let found = found.is_ok_and(|out| out.status.success());
    if !found {
        println!("no {program} here: not tested");
    }
    found
}

/// A folder with jobs and what one process makes of them, in `whole`.
fn with_jobs() -> tempfile::TempDir {
    let directory = workplace();
    write(directory.path(), "jobs.jsonl", &of_all_kinds(12));
    run(directory.path(), "batch jobs.jsonl -q -o whole", 0);
    directory
}

#[test]
fn gnu_parallel() {
    if !is_installed("parallel") {
        return;
    }
    let directory = with_jobs();
    let at = directory.path();
    shell(
        at,
        "parallel -j 2 warpath batch jobs.jsonl -q -t 1 --memory 10% --shard {}/4 -o out/{} ::: 1 2 3 4",
    );
    shell(at, "warpath merge out/[1-4] -o out/all -q");
    assert_same_files(&at.join("whole"), &at.join("out/all"));
    // A list of machines' worth of samples.
    shell(
        at,
        "parallel -j 2 warpath batch jobs.jsonl -q -t 1 --shard {}/3 --split samples -o samples/{} ::: 1 2 3",
    );
    shell(at, "warpath merge samples/[1-3] -o samples/all -q");
}

#[test]
fn open_mpi() {
    if !is_installed("mpirun") {
        return;
    }
    let directory = with_jobs();
    let at = directory.path();
    let line = "warpath batch jobs.jsonl -q -t 1 --memory 10% --shard auto -o 'out/{shard}'";
    shell(
        at,
        &format!("mpirun --allow-run-as-root --oversubscribe -n 3 {line}"),
    );
    shell(at, "warpath merge out/*-of-3 -o out/all -q");
    assert_same_files(&at.join("whole"), &at.join("out/all"));
}

/// Ends what it holds when the test does, however it does.
struct Processes(Vec<String>);

impl Drop for Processes {
    fn drop(&mut self) {
        for process in &self.0 {
            let _ = Command::new("kill").arg(process).status();
        }
    }
}

#[test]
fn a_slurm_array() {
    if !["munged", "slurmctld", "slurmd", "sbatch"]
        .into_iter()
        .all(is_installed)
    {
        return;
    }
    let directory = with_jobs();
    let at = directory.path();
    let started = Command::new("scripts/one-node-slurm")
        .arg(at.join("slurm"))
        .output()
        .unwrap();
    assert!(started.status.success());
    let numbers = String::from_utf8(started.stdout).unwrap();
    let _processes = Processes(numbers.lines().map(str::to_string).collect());
    std::fs::write(
        at.join("array.sh"),
        "#!/bin/bash\n#SBATCH --array=0-2 --ntasks=1\n\
         srun warpath batch jobs.jsonl -q -t 1 --memory 10% --shard auto -o 'out/{shard}' --resume\n",
    )
    .unwrap();
    let conf = at.join("slurm/slurm.conf");
    let conf = conf.display();
    shell(
        at,
        &format!(
            "export SLURM_CONF={conf}; for _ in $(seq 60); do sinfo -h | grep -q idle && break; sleep 0.5; done; sbatch --wait array.sh"
        ),
    );
    shell(at, "warpath merge out/*-of-3 -o out/all -q");
    assert_same_files(&at.join("whole"), &at.join("out/all"));
}
