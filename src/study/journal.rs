//! `study.jsonl`: a line for each direction that is done, so that an interrupted study goes on.

use super::cell::Row;
use crate::jobs::failure::Failure;
use crate::output::{FileError, atomic, plain};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::Write;
use std::path::{Path, PathBuf};

const NAME: &str = "study.jsonl";

/// The directions that are done.
pub struct Journal {
    path: PathBuf,
    file: File,
    lines: Vec<Line>,
    /// Held while the study runs: two in one folder would time each other.
    _lock: File,
}

#[derive(Serialize, Deserialize)]
struct Line {
    key: u64,
    row: Row,
}

impl Journal {
    /// Opens the folder's journal. Without `resume` there must be none yet. A line that was cut off
    /// or is of another version is left out: its direction is measured again.
    pub fn open(folder: &Path, resume: bool) -> Result<Self, Failure> {
        atomic::prepare_directory(folder)?;
        let unread = |error: &std::io::Error| FileError::io(folder, plain(error));
        let lock = File::open(folder).map_err(|error| unread(&error))?;
        if let Err(TryLockError::WouldBlock) = lock.try_lock() {
            let what = format!("{}: another study is writing there", folder.display());
            return Err(Failure::System(what));
        }
        let path = folder.join(NAME);
        let text = fs::read_to_string(&path).unwrap_or_default();
        if !resume && !text.is_empty() {
            return Err(Failure::Usage(format!(
                "{} has results already: --resume goes on with them, or choose another -o",
                path.display()
            )));
        }
        let whole = text
            .lines()
            .filter_map(|line| serde_json::from_str(line).ok());
        let lines: Vec<Line> = whole.collect();
        let kept: Vec<String> = lines.iter().map(json).collect::<Result<_, _>>()?;
        atomic::write(&path, |file| file.write_all(kept.concat().as_bytes()))?;
        let file = OpenOptions::new().append(true).open(&path);
        Ok(Self {
            file: file.map_err(|error| FileError::io(&path, plain(&error)))?,
            path,
            lines,
            _lock: lock,
        })
    }

    /// The direction of this key, if it is done.
    pub fn find(&self, key: u64) -> Option<&Row> {
        self.lines.iter().find(|l| l.key == key).map(|l| &l.row)
    }

    /// Adds a direction, and returns once it would survive a power cut.
    pub fn add(&mut self, key: u64, row: Row) -> Result<(), Failure> {
        let line = Line { key, row };
        let text = json(&line)?;
        let written = self.file.write_all(text.as_bytes());
        let written = written.and_then(|()| self.file.sync_data());
        written.map_err(|error| FileError::io(&self.path, plain(&error)))?;
        self.lines.push(line);
        Ok(())
    }
}

fn json(line: &Line) -> Result<String, Failure> {
    let text = serde_json::to_string(line);
    Ok(text.map_err(|error| Failure::System(error.to_string()))? + "\n")
}
