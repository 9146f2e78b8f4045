//! `results.jsonl`: one line a job, on the disk before anyone is told.

use super::failure::Failure;
use super::result::ResultLine;
use crate::output::{FileError, atomic};
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The name of the file.
pub const RESULTS: &str = "results.jsonl";

/// The results of a batch, open for more.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    /// Bytes of whole lines.
    length: u64,
    /// Held while the batch runs: two batches in one folder would lose each other's results.
    _lock: File,
}

/// What an earlier run has left.
#[derive(Debug, Default)]
pub struct Earlier {
    /// Jobs that are done, as they stand in the file.
    pub done: Vec<(ResultLine, String)>,
    /// Jobs that failed and will be run again: their lines are taken out.
    pub failed: usize,
    /// Whether the last line was torn, as a kill or a full disk leaves it.
    pub torn: bool,
}

impl Journal {
    /// Opens the results in `directory`. Without `resume` there must be none yet.
    pub fn open(directory: &Path, resume: bool) -> Result<(Self, Earlier), Failure> {
        atomic::prepare_directory(directory)?;
        let lock = lock(directory)?;
        let path = directory.join(RESULTS);
        let text = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(FileError::io(&path, atomic::plain(&error)).into()),
        };
        if !resume && !text.is_empty() {
            return Err(Failure::Usage(format!(
                "{} has results already: --resume goes on with them, or choose another -o",
                path.display()
            )));
        }
        let earlier = read(&path, &text)?;
        let kept: usize = earlier.done.iter().map(|(_, text)| text.len() + 1).sum();
        if kept != text.len() {
            atomic::write_durably(&path, |file| {
                for (_, text) in &earlier.done {
                    writeln!(file, "{text}")?;
                }
                Ok(())
            })?;
        }
        let open = OpenOptions::new().create(true).append(true).open(&path);
        let file = open.map_err(|error| FileError::io(&path, atomic::plain(&error)))?;
        atomic::sync_directory(directory)?;
        let length = kept as u64;
        let journal = Self {
            path,
            file,
            length,
            _lock: lock,
        };
        Ok((journal, earlier))
    }

    /// Adds a line, and returns once it would survive a power cut.
    pub fn append(&mut self, line: &str) -> Result<(), Failure> {
        let text = format!("{line}\n");
        let written = self
            .file
            .write_all(text.as_bytes())
            .and_then(|()| self.file.sync_data());
        match written {
            Ok(()) => {
                self.length += text.len() as u64;
                Ok(())
            }
            Err(error) => {
                // Half a line would be dropped on resuming all the same; the error of the write is the one to tell.
                let _ = self.file.set_len(self.length);
                let what = format!("cannot be written: {}", atomic::plain(&error));
                Err(FileError::io(&self.path, what).into())
            }
        }
    }
}

/// Reads the results of a batch that may have been cut off at any byte.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Earlier, Failure> {
    let mut earlier = Earlier::default();
    let mut lines = bytes
        .split_inclusive(|&byte| byte == b'\n')
        .enumerate()
        .peekable();
    while let Some((number, line)) = lines.next() {
        let is_last = lines.peek().is_none();
        let whole = line.strip_suffix(b"\n");
        let text = whole.and_then(|line| std::str::from_utf8(line).ok());
        let parsed = text.and_then(|text| Some((serde_json::from_str(text).ok()?, text)));
        match parsed {
            Some((result, text)) => {
                let result: ResultLine = result;
                match result.is_ok() {
                    true => earlier.done.push((result, text.to_string())),
                    false => earlier.failed += 1,
                }
            }
            None if is_last => earlier.torn = true,
            None => {
                return Err(Failure::Input(format!(
                    "{}:{}: not a result line of this version of warpath",
                    path.display(),
                    number + 1
                )));
            }
        }
    }
    Ok(earlier)
}

fn lock(directory: &Path) -> Result<File, Failure> {
    let file =
        File::open(directory).map_err(|error| FileError::io(directory, atomic::plain(&error)))?;
    match file.try_lock() {
        Err(fs::TryLockError::WouldBlock) => Err(Failure::World(format!(
            "{}: another batch is writing there",
            directory.display()
        ))),
        // Some network file systems have no locks: then it is up to the user.
        Ok(()) | Err(fs::TryLockError::Error(_)) => Ok(file),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(id: &str, ok: bool) -> String {
        let status = if ok { "ok" } else { "failed" };
        let code = if ok { 0 } else { 3 };
        format!(r#"{{"id":"{id}","line":1,"job":"x","status":"{status}","code":{code}}}"#)
    }

    #[test]
    fn a_file_cut_at_any_byte_keeps_its_whole_lines() {
        let text = format!(
            "{}\n{}\n{}\n",
            line("a", true),
            line("b", false),
            line("c", true)
        );
        let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at + 1).collect();
        for cut in 0..=text.len() {
            let earlier = read(Path::new("r"), &text.as_bytes()[..cut]).unwrap();
            let whole = ends.iter().filter(|end| **end <= cut).count();
            assert_eq!(earlier.done.len() + earlier.failed, whole, "{cut}");
            let ids: Vec<_> = earlier
                .done
                .iter()
                .filter_map(|(r, _)| r.id.clone())
                .collect();
            assert_eq!(ids, ["a", "c"][..whole.div_ceil(2)], "{cut}");
            assert_eq!(earlier.torn, cut > 0 && !ends.contains(&cut), "{cut}");
        }
        let broken = format!("{}\nrubbish\n{}\n", line("a", true), line("c", true));
        let error = read(Path::new("r"), broken.as_bytes()).unwrap_err();
        assert!(error.to_string().starts_with("r:2:"), "{error}");
    }

    #[test]
    fn resuming_takes_out_what_failed_and_what_is_torn() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(RESULTS);
        let text = format!("{}\n{}\n{{\"id\":\"c", line("a", true), line("b", false));
        fs::write(&path, text).unwrap();
        assert!(Journal::open(directory.path(), false).is_err());
        let (mut journal, earlier) = Journal::open(directory.path(), true).unwrap();
        assert_eq!(
            (earlier.done.len(), earlier.failed, earlier.torn),
            (1, 1, true)
        );
        let second = Journal::open(directory.path(), true).unwrap_err();
        assert!(second.to_string().contains("another batch"), "{second}");
        journal.append(&line("d", true)).unwrap();
        let now = fs::read_to_string(&path).unwrap();
        assert_eq!(now, format!("{}\n{}\n", line("a", true), line("d", true)));
    }
}
