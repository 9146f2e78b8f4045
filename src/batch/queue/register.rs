//! Lines of jobs, looked at before they are run: whose they are, and whether they are done already.

use crate::batch::results::journal::Earlier;
use crate::batch::results::line::ResultLine;
use crate::jobs::failure::Failure;
use crate::jobs::id::check_id;
use crate::scene::source::Fnv1a;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::collections::HashMap;

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
    /// The hash that its scene had when an earlier run did a job of it.
    pub scene_before: Option<String>,
}

/// What is looked at before a line is read in earnest.
#[derive(Default, Deserialize)]
#[serde(default)]
pub struct Outline<'a> {
    pub id: Option<String>,
    pub scene: Option<String>,
    #[serde(borrow)]
    pub defines: Option<&'a RawValue>,
}

/// What is known of ids: who has them, and what was done before.
#[derive(Default)]
pub struct Register {
    lines: HashMap<String, usize>,
    earlier: HashMap<String, ResultLine>,
    /// Hashes of the scenes of jobs that are done.
    scenes: HashMap<String, String>,
}

/// A line that has been looked at.
pub enum Entry {
    Run(Line),
    /// An earlier run has done it: its result line, with the number that the job has now.
    Done(String),
    /// An earlier run has done another job of this id: the refusal says so.
    Unlike(Line),
}

impl Register {
    /// With the jobs of earlier runs.
    pub fn new(earlier: Earlier) -> Self {
        let done = earlier.done.into_iter();
        let by_id = done.filter_map(|(line, _)| Some((line.id.clone()?, line)));
        Self {
            earlier: by_id.collect(),
            ..Self::default()
        }
    }

    /// Looks at a line: who it is, and whether it is to be run.
    pub fn enter(&mut self, number: usize, text: &str) -> Entry {
        let text = text.trim();
        let outline: Outline = serde_json::from_str(text).unwrap_or_default();
        let mut line = Line {
            number,
            text: text.to_string(),
            hash: hash(text),
            id: outline.id.filter(|id| check_id(id).is_ok()),
            refusal: None,
            scene_before: None,
        };
        let Some(id) = line.id.clone() else {
            return Entry::Run(line);
        };
        if let Some(done) = self.earlier.get(&id)
            && !self.lines.contains_key(&id)
        {
            if done.job != line.hash {
                line.refusal = Some(Failure::Usage(format!(
                    "the results have another job {id} (line {} then): give this one a new id, or choose another -o",
                    done.line
                )));
                return Entry::Unlike(line);
            }
            self.lines.insert(id, number);
            if let Some(hash) = &done.scene_hash {
                self.scenes.insert(scene_of(text), hash.clone());
            }
            let now = ResultLine {
                line: number,
                ..done.clone()
            };
            return Entry::Done(now.text());
        }
        let first = *self.lines.entry(id.clone()).or_insert(number);
        if first != number {
            let what = format!("id: {id} is that of line {first} already");
            line.refusal = Some(Failure::Input(what));
        }
        Entry::Run(line)
    }

    /// The hash that the scene of a line had when an earlier run did a job of it, as far as lines
    /// have been looked at.
    pub fn scene_before(&self, text: &str) -> Option<String> {
        // Most batches have no earlier run.
        let known = (!self.scenes.is_empty()).then(|| self.scenes.get(&scene_of(text)));
        known.flatten().cloned()
    }
}

/// Tells texts apart.
pub fn hash(text: &str) -> String {
    let mut hash = Fnv1a::default();
    hash.write(text.as_bytes());
    format!("fnv1a64:{:016x}", hash.0)
}

/// Tells scenes apart as far as the order of jobs needs it.
pub fn scene_of(text: &str) -> String {
    let outline: Outline = serde_json::from_str(text).unwrap_or_default();
    let defines = outline.defines.map_or("", RawValue::get);
    format!("{}\0{defines}", outline.scene.unwrap_or_default())
}
