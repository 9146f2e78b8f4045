//! The jobs of a file, sorted so that each scene loads once.

use super::register::{Entry, Line, Register, hash, scene_of};
use super::shard::Shard;
use crate::batch::results::journal::Earlier;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use std::collections::{HashMap, VecDeque};
use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::Path;

/// Jobs of a scene that are left when the next scene begins to load.
const BEFORE_THE_NEXT: usize = 8;

/// The jobs of a file.
pub struct JobFile {
    /// To be run, scene by scene.
    pub lines: VecDeque<Line>,
    /// Done by an earlier run.
    pub done: usize,
    /// Of everything in the file, whichever shard it belongs to.
    pub hash: String,
}

impl JobFile {
    /// Refuses a file that is not there, and begins no pipe.
    pub fn check(path: &Path) -> Result<(), FileError> {
        let found = fs::metadata(path).and_then(|about| match about.file_type() {
            kind if kind.is_dir() => Err(ErrorKind::IsADirectory.into()),
            kind if kind.is_file() => File::open(path).map(drop),
            _ => Ok(()),
        });
        found.map_err(|error| FileError::unread(path, &error))
    }

    /// Looks at all lines of `path`, and keeps those of `shard`.
    pub fn read(path: &Path, shard: Option<Shard>, earlier: Earlier) -> Result<Self, Failure> {
        let text = fs::read(path).map_err(|error| FileError::unread(path, &error))?;
        let mut register = Register::new(earlier);
        let mut places: HashMap<String, usize> = HashMap::new();
        let mut lines: Vec<(usize, Line)> = Vec::new();
        let mut done = 0;
        let mut jobs = 0;
        for (at, line) in text.split(|&byte| byte == b'\n').enumerate() {
            // What is not UTF-8 is refused with its line, as JSON that cannot be read.
            let line = String::from_utf8_lossy(line);
            if line.trim().is_empty() {
                continue;
            }
            let is_ours = shard.is_none_or(|shard| shard.has(jobs));
            jobs += 1;
            match register.enter(at + 1, &line) {
                Entry::Unlike(Line {
                    number, refusal, ..
                }) => {
                    let what = refusal.map_or_else(String::new, |why| why.to_string());
                    let what = format!("{}: line {number}: {what}", path.display());
                    return Err(Failure::Usage(what));
                }
                _ if !is_ours => {}
                Entry::Done(_) => done += 1,
                Entry::Run(line) => {
                    let next = places.len();
                    let place = *places.entry(scene_of(&line.text)).or_insert(next);
                    lines.push((place, line));
                }
            }
        }
        // Once all are known that are done.
        for (_, line) in &mut lines {
            line.scene_before = register.scene_before(&line.text);
        }
        // Stable: within a scene the order is the file's.
        lines.sort_by_key(|(place, _)| *place);
        Ok(Self {
            lines: in_time(lines),
            done,
            hash: hash(&String::from_utf8_lossy(&text)),
        })
    }
}

/// Takes the first job of each scene before the last ones of the scene before it: while it loads,
/// they are run.
fn in_time(lines: Vec<(usize, Line)>) -> VecDeque<Line> {
    let mut scenes: Vec<VecDeque<Line>> = Vec::new();
    for (place, line) in lines {
        scenes.resize_with(scenes.len().max(place + 1), VecDeque::new);
        scenes[place].push_back(line);
    }
    let mut order = VecDeque::new();
    let mut scenes = scenes.into_iter().peekable();
    order.extend(scenes.peek_mut().and_then(VecDeque::pop_front));
    while let Some(mut scene) = scenes.next() {
        let last = scene.split_off(scene.len().saturating_sub(BEFORE_THE_NEXT));
        order.extend(scene);
        order.extend(scenes.peek_mut().and_then(VecDeque::pop_front));
        order.extend(last);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn jobs_of_one_scene_stand_together_and_ids_stand_once() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("jobs.jsonl");
        let lines = [
            r#"{"id":"a","scene":"s.xml"}"#,
            r#"{"id":"b","scene":"t.xml"}"#,
            "",
            "not JSON",
            r#"{"id":"c","scene":"s.xml","defines":{"x":1}}"#,
            r#"{"id":"d","scene":"s.xml"}"#,
            r#"{"id":"a","scene":"t.xml"}"#,
        ];
        std::fs::write(&path, lines.join("\n")).unwrap();
        let read = |shard| {
            JobFile::read(&path, shard, Earlier::default())
                .unwrap()
                .lines
        };
        let numbers = |shard| -> Vec<usize> { read(shard).iter().map(|l| l.number).collect() };
        // The first of each scene comes before the last of the one before it.
        assert_eq!(numbers(None), [1, 2, 6, 4, 7, 5]);
        let refused: Vec<usize> = read(None)
            .iter()
            .filter(|l| l.refusal.is_some())
            .map(|l| l.number)
            .collect();
        assert_eq!(refused, [7]);
        let mut all: Vec<usize> = (1..=3)
            .flat_map(|index| numbers(Some(Shard { index, count: 3 })))
            .collect();
        all.sort_unstable();
        assert_eq!(all, [1, 2, 4, 5, 6, 7]);
    }
}
