//! Lines of jobs: from a file, sorted so that each scene loads once, or from a stream, as they come.

use super::shard::Shard;
use crate::batch::results::journal::Earlier;
use crate::batch::results::line::ResultLine;
use crate::jobs::failure::Failure;
use crate::jobs::id::check_id;
use crate::scene::source::Fnv1a;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::collections::{HashMap, VecDeque};
use std::path::Path;

/// Jobs of a scene that are left when the next scene begins to load.
const BEFORE_THE_NEXT: usize = 8;

/// A line that is to be run.
#[derive(Debug)]
pub struct Line {
    /// From 1; empty lines are counted and left out.
    pub number: usize,
    pub text: String,
    /// Of the text.
    pub hash: String,
    pub id: Option<String>,
    /// Why it will not be run.
    pub refusal: Option<Failure>,
}

/// What is looked at before a line is read in earnest.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Outline<'a> {
    id: Option<String>,
    scene: Option<String>,
    #[serde(borrow)]
    defines: Option<&'a RawValue>,
}

/// What is known of ids: who has them, and what was done before.
#[derive(Default)]
pub struct Register {
    lines: HashMap<String, usize>,
    earlier: HashMap<String, (ResultLine, String)>,
}

/// A line that has been looked at.
pub enum Entry {
    Run(Line),
    /// An earlier run has done it: its result line.
    Done(String),
}

impl Register {
    /// With the jobs of earlier runs.
    pub fn new(earlier: Earlier) -> Self {
        let done = earlier.done.into_iter();
        let by_id = done.filter_map(|(line, text)| Some((line.id.clone()?, (line, text))));
        Self {
            lines: HashMap::new(),
            earlier: by_id.collect(),
        }
    }

    /// Looks at a line: who it is, and whether it is to be run. An error if the earlier run's job of this id is another.
    pub fn enter(&mut self, number: usize, text: &str) -> Result<Entry, Failure> {
        let text = text.trim();
        let hash = hash(text);
        let outline: Outline = serde_json::from_str(text).unwrap_or_default();
        let id = outline.id.filter(|id| check_id(id).is_ok());
        let mut refusal = None;
        if let Some(id) = &id {
            if let Some((done, line)) = self.earlier.get(id)
                && !self.lines.contains_key(id)
            {
                if done.job != hash {
                    return Err(Failure::Usage(format!(
                        "line {number}: the results have another job {id} (line {} then): give this one a new id, or \
                         choose another -o",
                        done.line
                    )));
                }
                self.lines.insert(id.clone(), number);
                return Ok(Entry::Done(line.clone()));
            }
            let first = *self.lines.entry(id.clone()).or_insert(number);
            if first != number {
                refusal = Some(Failure::Input(format!(
                    "id: {id} is that of line {first} already"
                )));
            }
        }
        Ok(Entry::Run(Line {
            number,
            text: text.to_string(),
            hash,
            id,
            refusal,
        }))
    }
}

fn hash(text: &str) -> String {
    let mut hash = Fnv1a::default();
    hash.write(text.as_bytes());
    format!("fnv1a64:{:016x}", hash.0)
}

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
    /// Looks at all lines of `path`, and keeps those of `shard`.
    pub fn read(path: &Path, shard: Option<Shard>, earlier: Earlier) -> Result<Self, Failure> {
        let text = std::fs::read(path).map_err(|error| {
            let what = crate::output::atomic::plain(&error);
            let what = format!("{}: {what}", path.display());
            match error.kind() {
                std::io::ErrorKind::NotFound | std::io::ErrorKind::IsADirectory => {
                    Failure::Input(what)
                }
                _ => Failure::System(what),
            }
        })?;
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
            let entry = register
                .enter(at + 1, &line)
                .map_err(|failure| Failure::Usage(format!("{}: {failure}", path.display())))?;
            match entry {
                _ if !is_ours => {}
                Entry::Done(_) => done += 1,
                Entry::Run(line) => {
                    let next = places.len();
                    let place = *places.entry(scene_of(&line.text)).or_insert(next);
                    lines.push((place, line));
                }
            }
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

/// Takes the first job of each scene before the last ones of the scene before it: while it loads, they are run.
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

/// Tells scenes apart as far as the order of jobs needs it.
fn scene_of(text: &str) -> String {
    let outline: Outline = serde_json::from_str(text).unwrap_or_default();
    let defines = outline.defines.map_or("", RawValue::get);
    format!("{}\0{defines}", outline.scene.unwrap_or_default())
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
