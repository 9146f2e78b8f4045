//! The whole program on scenes, meshes, pictures, arrays and jobs that were changed at random: whatever it is given, it
//! ends with a code that is documented and a message, or with results that are whole and finite.
//!
//! A case is drawn from a seed and its number alone. `WARPATH_MUTATIONS` is how many executions there are,
//! `WARPATH_MUTATION_SEED` another seed. What fails is shrunk, by leaving out mutations that do not matter, and kept in a
//! folder with the commands in `cmd`.

mod again;
mod arguments;
mod bytes;
mod case;
mod element;
mod extremes;
mod jobs;
mod materials;
mod meshes;
#[path = "../../picture_files/mod.rs"]
mod picture_files;
mod pictures;
mod process;
mod promises;
mod random;
mod results;
mod scenes;
mod xml;

use case::{Case, Step};
use promises::Violation;
use random::Random;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

const PROCESSES: usize = 2;
/// Cases of one kind that are kept.
const KEPT: usize = 3;

/// A case that broke a promise.
struct Found {
    index: u64,
    violation: Violation,
    mutations: Vec<String>,
    folder: PathBuf,
}

/// Runs as many executions as asked for and lists all promises that were broken.
pub fn campaign(executions: usize) {
    let asked = |name: &str| Some(std::env::var(name).ok()?.parse::<u64>().expect(name));
    let executions = asked("WARPATH_MUTATIONS").map_or(executions, |n| n as usize);
    let seed = asked("WARPATH_MUTATION_SEED").unwrap_or(1);
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("mutations-{seed}"));
    let _ = fs::remove_dir_all(&kept);
    let begun = Instant::now();
    let next = AtomicU64::new(0);
    let (done, processes) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let found: Mutex<BTreeMap<String, (usize, Vec<Found>)>> = Mutex::default();
    let codes: Mutex<BTreeMap<String, usize>> = Mutex::default();
    std::thread::scope(|scope| {
        for _ in 0..PROCESSES {
            scope.spawn(|| {
                let place = tempfile::tempdir().expect("a folder");
                while done.load(Ordering::Relaxed) < executions {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    let case = Case::draw(seed, index, &BTreeSet::new());
                    let outcome = execute(&case, place.path());
                    done.fetch_add(case.executions, Ordering::Relaxed);
                    processes.fetch_add(outcome.ends.len(), Ordering::Relaxed);
                    for end in &outcome.ends {
                        let mut codes = codes.lock().expect("no panic");
                        *codes.entry(end.clone()).or_default() += 1;
                    }
                    let Some(violation) = outcome.violation else {
                        continue;
                    };
                    let kind = violation.kind.clone();
                    let number = {
                        let mut found = found.lock().expect("no panic");
                        let (count, _) = found.entry(kind.clone()).or_default();
                        *count += 1;
                        *count
                    };
                    if number <= KEPT {
                        let folder = kept.join(format!("{}-{index}", file_name(&kind)));
                        let case = shrink(seed, index, &kind, place.path());
                        let case = keep(seed, index, violation, case, &folder);
                        let mut found = found.lock().expect("no panic");
                        found.entry(kind).or_default().1.push(case);
                    }
                }
            });
        }
    });
    let seconds = begun.elapsed().as_secs_f64();
    println!(
        "seed {seed}: {} executions, {} processes in {seconds:.0} s; ends: {:?}",
        done.into_inner(),
        processes.into_inner(),
        codes.into_inner().expect("no panic")
    );
    let found = found.into_inner().expect("no panic");
    let report: Vec<String> = found
        .iter()
        .map(|(kind, (n, cases))| told(kind, *n, cases))
        .collect();
    assert!(
        found.is_empty(),
        "{} kinds of broken promises; cases are in {}\n{}",
        found.len(),
        kept.display(),
        report.join("\n")
    );
}

struct Outcome {
    violation: Option<Violation>,
    /// Each command and how it ended.
    ends: Vec<String>,
}

/// Runs a case in a fresh folder in `place`.
fn execute(case: &Case, place: &Path) -> Outcome {
    let directory = place.join("case");
    let _ = fs::remove_dir_all(&directory);
    fs::create_dir(&directory).expect("a folder");
    for (name, bytes) in &case.files {
        fs::write(directory.join(name), bytes).expect("a file");
    }
    let mut ends = Vec::new();
    let mut damaged = false;
    for step in &case.steps {
        match step {
            Step::Damage(random) => {
                damage(&directory, case, random.clone());
                damaged = true;
            }
            Step::Run { arguments, input } => {
                let ended = process::run(&directory, place, arguments, input.as_deref());
                let command = arguments.first().map_or("", String::as_str);
                ends.push(format!("{command} {:?}", ended.code.unwrap_or(-1)));
                let broken = promises::broken(&directory, arguments, &ended, damaged);
                let broken = broken.or_else(|| match case.runs_again && ended.code == Some(0) {
                    true => again::differs(&directory, place, arguments),
                    false => None,
                });
                if broken.is_some() {
                    return Outcome {
                        violation: broken,
                        ends,
                    };
                }
            }
        }
    }
    Outcome {
        violation: None,
        ends,
    }
}

/// Damages a file about the run that a run has written, or a part of a job's samples: nobody reads the others again.
fn damage(directory: &Path, case: &Case, mut random: Random) {
    let mut files = Vec::new();
    collect(directory, &mut files);
    let name = |path: &PathBuf| path.file_name().map(|n| n.to_string_lossy().into_owned());
    let is_read = |name: String| {
        let ours = case.files.contains_key(&name);
        !ours
            && [".json", ".jsonl", "partial.safetensors"]
                .iter()
                .any(|end| name.ends_with(end))
    };
    files.retain(|path| name(path).is_some_and(is_read));
    files.sort();
    if files.is_empty() {
        return;
    }
    let path = random.pick(&files);
    if random.chance(15) {
        return fs::remove_file(path).expect("a file");
    }
    let mut bytes = fs::read(path).expect("a file");
    bytes::damage(&mut bytes, &mut random);
    fs::write(path, bytes).expect("a file");
}

fn collect(directory: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).expect("a folder") {
        let path = entry.expect("an entry").path();
        match path.is_dir() {
            true => collect(&path, files),
            false => files.push(path),
        }
    }
}

/// The same case with as few mutations as break the same promise.
fn shrink(seed: u64, index: u64, kind: &str, place: &Path) -> Case {
    let mut dropped = BTreeSet::new();
    let all: Vec<usize> = Case::draw(seed, index, &dropped)
        .mutations
        .into_keys()
        .collect();
    for n in all {
        dropped.insert(n);
        let fewer = execute(&Case::draw(seed, index, &dropped), place);
        if fewer.violation.is_none_or(|v| v.kind != kind) {
            dropped.remove(&n);
        }
    }
    Case::draw(seed, index, &dropped)
}

/// Writes a case where it can be run by hand.
fn keep(seed: u64, index: u64, violation: Violation, case: Case, folder: &Path) -> Found {
    fs::create_dir_all(folder).expect("a folder");
    for (name, bytes) in &case.files {
        fs::write(folder.join(name), bytes).expect("a file");
    }
    let mutations: Vec<String> = case.mutations.values().cloned().collect();
    let mut commands = format!("# seed {seed}, case {index}: {}\n", violation.kind);
    for mutation in &mutations {
        commands += &format!("# {mutation:?}\n");
    }
    for step in &case.steps {
        commands += &match step {
            Step::Damage(_) => "# a file of what was written is damaged\n".into(),
            Step::Run { arguments, input } => {
                let words: Vec<String> = arguments.iter().map(|a| quoted(a)).collect();
                let from = if input.is_some() { " < jobs.jsonl" } else { "" };
                format!("warpath {}{from}\n", words.join(" "))
            }
        };
    }
    fs::write(folder.join("cmd"), &commands).expect("a file");
    Found {
        index,
        violation,
        mutations,
        folder: folder.to_path_buf(),
    }
}

/// For a shell.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:@#".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.into(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    }
}

fn file_name(kind: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '-' };
    let name: String = kind.chars().map(plain).collect();
    name.chars().take(60).collect()
}

fn told(kind: &str, count: usize, cases: &[Found]) -> String {
    let mut out = format!("{kind}: {count} times");
    for case in cases {
        let detail = case.violation.detail.lines().take(4);
        let detail: Vec<&str> = detail.collect();
        out += &format!(
            "\n  case {}: {}\n    {}\n    {}",
            case.index,
            case.mutations.join("; "),
            detail.join("\n    "),
            case.folder.display()
        );
    }
    out
}
