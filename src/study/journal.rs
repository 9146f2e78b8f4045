//! `study.jsonl`: a line for each direction that is done, so that an interrupted study goes on.

use super::cell::Row;
use crate::jobs::failure::Failure;
use crate::jobs::read::without_line;
use crate::output::{FileError, atomic, plain};
use serde::{Deserialize, Serialize};
use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A line for each direction that is done.
pub const JOURNAL: &str = "study.jsonl";

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
    /// Opens the folder's journal. Without `resume` there must be none yet. A last line that was
    /// cut off is left out: its direction is measured again.
    pub fn open(folder: &Path, resume: bool) -> Result<Self, Failure> {
        atomic::prepare_directory(folder)?;
        let lock = atomic::claim(folder, "study")?;
        let path = folder.join(JOURNAL);
        let bytes = match fs::read(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => Vec::new(),
            read => read.map_err(|error| FileError::unread(&path, &error))?,
        };
        if !resume && !bytes.is_empty() {
            return Err(Failure::Usage(format!(
                "{} has results already: --resume goes on with them, or choose another -o",
                path.display()
            )));
        }
        let lines = read(&path, &bytes)?;
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

/// Reads a journal that may have been cut off at any byte. A line's end is written last: any line
/// with one that cannot be read was edited, or is of another version.
fn read(path: &Path, bytes: &[u8]) -> Result<Vec<Line>, Failure> {
    let mut lines = Vec::new();
    for (at, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let whole = line.strip_suffix(b"\n");
        match serde_json::from_slice(whole.unwrap_or(line)) {
            Ok(line) => lines.push(line),
            Err(_) if whole.is_none() => {}
            Err(error) => {
                return Err(Failure::Input(format!(
                    "{}:{}: not a line of this version of warpath: {}. Mend it, or take it out: its direction is then \
                     measured again",
                    path.display(),
                    at + 1,
                    without_line(&error)
                )));
            }
        }
    }
    Ok(lines)
}

fn json(line: &Line) -> Result<String, Failure> {
    let text = serde_json::to_string(line);
    Ok(text.map_err(|error| Failure::System(error.to_string()))? + "\n")
}
