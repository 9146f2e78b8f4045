//! `results.jsonl`: one line a job, on the disk before anyone is told.

use super::folder;
use super::line::ResultLine;
use crate::jobs::failure::Failure;
use crate::jobs::id::RESULTS;
use crate::output::{FileError, atomic, plain};
use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

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

/// The results of a folder, looked at and locked, and nothing of them changed.
#[derive(Debug)]
pub struct Found {
    directory: PathBuf,
    path: PathBuf,
    /// The lines to keep, if they are not all that is there.
    kept: Option<Vec<u8>>,
    length: u64,
    lock: File,
}

impl Journal {
    /// Looks at the results in `directory`. Without `resume` there must be none yet.
    pub fn look(directory: &Path, resume: bool) -> Result<(Found, Earlier), Failure> {
        atomic::prepare_directory(directory)?;
        let lock = atomic::claim(directory, "batch")?;
        folder::refuse_links(directory)?;
        let path = directory.join(RESULTS);
        let text = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => Vec::new(),
            Err(error) => return Err(FileError::io(&path, plain(&error)).into()),
        };
        if !resume && !text.is_empty() {
            return Err(Failure::Usage(format!(
                "{} has results already: --resume goes on with them, or choose another -o",
                path.display()
            )));
        }
        let earlier = read(&path, &text)?;
        let length: usize = earlier.done.iter().map(|(_, text)| text.len() + 1).sum();
        let kept = (length != text.len()).then(|| {
            let lines = earlier.done.iter().flat_map(|(_, text)| [text, "\n"]);
            lines.collect::<String>().into_bytes()
        });
        let found = Found {
            directory: directory.to_path_buf(),
            path,
            kept,
            length: length as u64,
            lock,
        };
        Ok((found, earlier))
    }
}

impl Found {
    /// Takes out what failed or is torn, and opens the results for more.
    pub fn begin(self) -> Result<Journal, Failure> {
        if let Some(kept) = &self.kept {
            atomic::write_durably(&self.path, |file| file.write_all(kept))?;
        }
        let open = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&self.path);
        let file = open.map_err(|error| FileError::io(&self.path, plain(&error)))?;
        atomic::sync_directory(&self.directory)?;
        Ok(Journal {
            path: self.path,
            file,
            length: self.length,
            _lock: self.lock,
        })
    }
}

impl Found {
    /// Writes all results at once, and returns when they would survive a power cut.
    pub fn write(self, lines: &[String]) -> Result<(), FileError> {
        atomic::write_durably(&self.path, |file| {
            lines.iter().try_for_each(|line| writeln!(file, "{line}"))
        })
    }
}

impl Journal {
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
                // Half a line would be dropped on resuming all the same; the error of the write is
                // the one to tell.
                let _ = self.file.set_len(self.length);
                let what = format!("cannot be written: {}", plain(&error));
                Err(FileError::io(&self.path, what).into())
            }
        }
    }
}

/// Reads the results of a batch that may have been cut off at any byte. A line's end is written
/// last: a line without one is torn; any other that is not a result was not written by a batch.
pub fn read(path: &Path, bytes: &[u8]) -> Result<Earlier, Failure> {
    let mut earlier = Earlier::default();
    let mut holders = HashMap::new();
    for (at, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        let Some(line) = line.strip_suffix(b"\n") else {
            earlier.torn = true;
            break;
        };
        let refused = |what: String| {
            Failure::Input(format!(
                "{}:{}: not a result line of this version of warpath: {what}. Mend the line, or take it out: its job is then \
                 run again",
                path.display(),
                at + 1
            ))
        };
        let text = std::str::from_utf8(line).map_err(|_| refused("not UTF-8".into()))?;
        let result = ResultLine::parse(text).map_err(refused)?;
        if !result.is_ok() {
            earlier.failed += 1;
            continue;
        }
        let id = result.id.clone().unwrap_or_default();
        if let Some(first) = holders.insert(id, at + 1) {
            return Err(refused(format!("line {first} has the result of this id")));
        }
        earlier.done.push((result, text.to_string()));
    }
    Ok(earlier)
}

/// Keeps batches from writing into a folder for as long as the file is held; none if one is writing
/// there now.
pub fn hold(directory: &Path) -> Result<Option<File>, FileError> {
    let file = File::open(directory).map_err(|error| FileError::unread(directory, &error))?;
    match file.try_lock_shared() {
        Err(fs::TryLockError::WouldBlock) => Ok(None),
        // As in `atomic::claim`.
        Ok(()) | Err(fs::TryLockError::Error(_)) => Ok(Some(file)),
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
    }

    #[test]
    fn a_whole_line_that_is_no_result_is_told_with_its_number() {
        let good = line("b", true);
        let broken = [
            ("rubbish".to_string(), "expected value"),
            (good.replace(r#""id":"b","#, ""), "missing field `id`"),
            (good.replace(r#""id":"b""#, r#""id":null"#), "without an id"),
            (good.replace(r#""id":"b""#, r#""id":"../b""#), "../b"),
            (line("a", true), "line 1 has the result of this id"),
            (good.replace(r#""ok""#, r#""okay""#), "okay"),
            (good.replace(r#""code":0"#, r#""code":3"#), "code 3"),
            (
                line("b", false).replace(r#""code":3"#, r#""code":0"#),
                "code 0",
            ),
            (String::new(), "EOF"),
        ];
        for (second, part) in broken {
            for rest in [String::new(), line("c", true) + "\n"] {
                let text = format!("{}\n{second}\n{rest}", line("a", true));
                let error = read(Path::new("r"), text.as_bytes()).unwrap_err();
                let (code, error) = (error.code(), error.to_string());
                assert!(
                    error.starts_with("r:2: ") && error.contains(part),
                    "{error}"
                );
                assert_eq!(code, 3, "{error}");
            }
        }
        // A job whose id could not be read failed without one.
        let nameless = line("b", false).replace(r#""b""#, "null") + "\n";
        assert_eq!(read(Path::new("r"), nameless.as_bytes()).unwrap().failed, 1);
    }

    #[test]
    fn resuming_takes_out_what_failed_and_what_is_torn() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join(RESULTS);
        let text = format!("{}\n{}\n{{\"id\":\"c", line("a", true), line("b", false));
        fs::write(&path, text).unwrap();
        assert!(Journal::look(directory.path(), false).is_err());
        let (found, earlier) = Journal::look(directory.path(), true).unwrap();
        assert_eq!(
            (earlier.done.len(), earlier.failed, earlier.torn),
            (1, 1, true)
        );
        let second = Journal::look(directory.path(), true).unwrap_err();
        assert!(second.to_string().contains("another batch"), "{second}");
        let mut journal = found.begin().unwrap();
        journal.append(&line("d", true)).unwrap();
        let now = fs::read_to_string(&path).unwrap();
        assert_eq!(now, format!("{}\n{}\n", line("a", true), line("d", true)));
    }
}
