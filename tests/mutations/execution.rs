//! A case in a folder of its own.

use super::case::{Case, Step};
use super::promises::Violation;
use super::random::Random;
use super::{again, bytes, process, promises};
use std::fs;
use std::path::{Path, PathBuf};

/// How a case went.
pub struct Outcome {
    pub violation: Option<Violation>,
    /// Each command and how it ended.
    pub ends: Vec<String>,
}

/// Runs a case in a fresh folder in `place`.
pub fn execute(case: &Case, place: &Path) -> Outcome {
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

/// Damages a file about the run that a run has written, or a part of a job's samples: nobody reads
/// the others again.
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
