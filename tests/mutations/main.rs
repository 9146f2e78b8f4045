//! The whole program on scenes, meshes, pictures, arrays and jobs that were changed at random:
//! whatever it is given, it ends with a code that is documented and a message, or with results that
//! are whole and finite.
//!
//! A case is drawn from a seed and its number alone. `WARPATH_MUTATIONS` is how many executions
//! there are, `WARPATH_MUTATION_SEED` another seed. What fails is shrunk, by leaving out mutations
//! that do not matter, and kept in a folder with the commands in `cmd`.
//!
//! Alone in its process: it keeps two processors busy, and tests beside it measure time.

mod again;
mod arguments;
mod bytes;
mod case;
mod element;
mod execution;
mod extremes;
mod findings;
mod jobs;
mod materials;
mod meshes;
mod pictures;
mod process;
mod promises;
mod random;
mod results;
mod scenes;
mod xml;

use case::Case;
use execution::{Outcome, execute};
use findings::Findings;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::time::Instant;

const PROCESSES: usize = 2;
/// At least this part of all processes succeeds: where all is refused at once nothing is tested.
const LEAST_SUCCESS: f64 = 0.15;

/// `make test-long` runs thousands, of which these are the first.
const EXECUTIONS: usize = if cfg!(feature = "long-tests") {
    20_000
} else {
    150
};

/// Runs as many executions as asked for and lists all promises that were broken.
#[test]
fn promises_hold_whatever_is_given() {
    let asked = |name: &str| Some(std::env::var(name).ok()?.parse::<u64>().expect(name));
    let executions = asked("WARPATH_MUTATIONS").map_or(EXECUTIONS, |n| n as usize);
    let seed = asked("WARPATH_MUTATION_SEED").unwrap_or(1);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mutations-{seed}"));
    let findings = Findings::new(seed, kept);
    let cases = Mutex::new(Cases::default());
    let ends: Mutex<BTreeMap<String, usize>> = Mutex::default();
    let begun = Instant::now();
    std::thread::scope(|scope| {
        for _ in 0..PROCESSES {
            scope.spawn(|| {
                let place = tempfile::tempdir().expect("a folder");
                loop {
                    let next = cases.lock().expect("no panic").next(seed, executions);
                    let Some((index, case)) = next else {
                        return;
                    };
                    let Outcome {
                        violation,
                        ends: these,
                    } = execute(&case, place.path());
                    for end in these {
                        *ends.lock().expect("no panic").entry(end).or_default() += 1;
                    }
                    if let Some(violation) = violation {
                        findings.add(index, violation, place.path());
                    }
                }
            });
        }
    });
    let ends = ends.into_inner().expect("no panic");
    let processes: usize = ends.values().sum();
    let good = ends.iter().filter(|(end, _)| end.ends_with(" 0"));
    let good: usize = good.map(|(_, count)| count).sum();
    println!(
        "seed {seed}: {} executions, {processes} processes in {:.0} s; ends: {ends:?}",
        cases.into_inner().expect("no panic").executions,
        begun.elapsed().as_secs_f64(),
    );
    findings.assert_none();
    assert!(
        good as f64 >= LEAST_SUCCESS * processes as f64,
        "only {good} of {processes} processes succeeded"
    );
}

/// Cases in their order, until there are enough: which there are does not depend on how fast they
/// run.
#[derive(Default)]
struct Cases {
    drawn: u64,
    executions: usize,
}

impl Cases {
    fn next(&mut self, seed: u64, executions: usize) -> Option<(u64, Case)> {
        if self.executions >= executions {
            return None;
        }
        let index = self.drawn;
        let case = Case::draw(seed, index, &Default::default());
        self.drawn += 1;
        self.executions += case.executions;
        Some((index, case))
    }
}
