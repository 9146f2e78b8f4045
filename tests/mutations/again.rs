//! The same command with another number of threads leaves the same bytes.

use super::process;
use super::promises::{Violation, value};
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Where the first run wrote, and where the second is to write.
const FOLDERS: [&str; 2] = ["out", "again"];
const THREADS: [&str; 3] = ["1", "2", "3"];

/// Runs a command that has succeeded once more and compares; says nothing of commands that
/// cannot be compared.
pub fn differs(directory: &Path, beside: &Path, arguments: &[String]) -> Option<Violation> {
    let command = arguments.first()?.as_str();
    let threads = value(arguments, "--threads")?;
    let is_comparable = ["render", "forward", "backward"].contains(&command)
        && directory.join(FOLDERS[0]).is_dir()
        && THREADS.contains(&threads)
        && value(arguments, "-o") == Some(FOLDERS[0]);
    if !is_comparable {
        return None;
    }
    let other = THREADS.iter().find(|t| **t != threads)?;
    let mut changed = arguments.to_vec();
    for i in 1..changed.len() {
        match changed[i - 1].as_str() {
            "--threads" => changed[i] = other.to_string(),
            "-o" => changed[i] = FOLDERS[1].into(),
            _ => {}
        }
    }
    let ended = process::run(directory, beside, &changed, None);
    if ended.code != Some(0) {
        let kind = format!("{command}: not on {other} threads");
        let stderr = String::from_utf8_lossy(&ended.stderr);
        return Some(Violation::new(kind, stderr));
    }
    let [first, second] = FOLDERS.map(|folder| results(&directory.join(folder)));
    let differ = first.keys().chain(second.keys());
    let mut differ = differ.filter(|name| first.get(*name) != second.get(*name));
    let name = differ.next()?;
    let kind = format!("{command}: another {name} on another number of threads");
    Some(Violation::new(
        kind,
        format!("{threads} and {other} threads"),
    ))
}

/// All files but the report, which tells of seconds.
fn results(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("a folder of results");
    let files = entries.map(|entry| {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default();
        let bytes = fs::read(&path).expect("a file");
        (name.to_string_lossy().into_owned(), bytes)
    });
    files.filter(|(name, _)| name != "report.json").collect()
}
