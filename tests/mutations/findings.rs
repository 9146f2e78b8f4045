//! Broken promises, shrunk and kept.

use super::case::{Case, Step};
use super::execution::execute;
use super::promises::Violation;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Cases of one kind that are kept.
const KEPT: usize = 3;

/// What a campaign found.
pub struct Findings {
    seed: u64,
    folder: PathBuf,
    /// By kind: how many, and those that are kept.
    found: Mutex<BTreeMap<String, (usize, Vec<Found>)>>,
}

/// A case that broke a promise.
struct Found {
    index: u64,
    violation: Violation,
    mutations: Vec<String>,
    folder: PathBuf,
}

impl Findings {
    /// Those of a seed, to be kept in a folder.
    pub fn new(seed: u64, folder: PathBuf) -> Self {
        // Of an earlier campaign.
        let _ = fs::remove_dir_all(&folder);
        Self {
            seed,
            folder,
            found: Mutex::default(),
        }
    }

    /// Counts what case `index` broke, and keeps it if there are few of its kind.
    pub fn add(&self, index: u64, violation: Violation, place: &Path) {
        let kind = violation.kind.clone();
        let number = {
            let mut found = self.found.lock().expect("no panic");
            let (count, _) = found.entry(kind.clone()).or_default();
            *count += 1;
            *count
        };
        if number > KEPT {
            return;
        }
        let folder = self.folder.join(format!("{}-{index}", file_name(&kind)));
        let case = shrink(self.seed, index, &kind, place);
        let case = keep(self.seed, index, violation, case, &folder);
        let mut found = self.found.lock().expect("no panic");
        found.entry(kind).or_default().1.push(case);
    }

    /// Fails with a list of all, if there are any.
    pub fn assert_none(self) {
        let found = self.found.into_inner().expect("no panic");
        let kinds = found.iter();
        let report: Vec<String> = kinds
            .map(|(kind, (n, cases))| told(kind, *n, cases))
            .collect();
        assert!(
            found.is_empty(),
            "{} kinds of broken promises; cases are in {}\n{}",
            found.len(),
            self.folder.display(),
            report.join("\n")
        );
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
