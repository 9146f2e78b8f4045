//! Writing a file so that a reader, or a crash, never meets half of it.

use super::error::FileError;
use super::unfinished::Unfinished;
use crate::files::plain;
use std::fs::{self, File, TryLockError};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Writes `path` through a temporary file beside it, which is renamed once it is complete and
/// removed if anything fails.
pub fn write(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    let done = (|| {
        let (unfinished, file) = Unfinished::file(temporary_name(path))?;
        let mut writer = BufWriter::new(file);
        fill(&mut writer)?;
        writer.flush()?;
        drop(writer);
        unfinished.becomes(path)
    })();
    done.map_err(|error| FileError::io(path, format_args!("cannot be written: {}", plain(&error))))
}

/// As [`write()`], and returns once the file would survive a power cut.
pub fn write_durably(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), FileError> {
    write(path, |writer| {
        fill(writer)?;
        writer.flush()?;
        writer.get_ref().sync_data()
    })?;
    sync_directory(path.parent().unwrap_or(Path::new(".")))
}

/// Sees to it that what was made, renamed and removed in a directory stays so after a power cut.
pub fn sync_directory(directory: &Path) -> Result<(), FileError> {
    let directory = match directory.as_os_str().is_empty() {
        true => Path::new("."),
        false => directory,
    };
    File::open(directory)
        .and_then(|file| file.sync_all())
        .map_err(|error| FileError::io(directory, plain(&error)))
}

/// Makes the directory and proves that files can be made in it, so that a long run does not end in
/// finding out that they cannot.
pub fn prepare_directory(directory: &Path) -> Result<(), FileError> {
    let probe = temporary_name(&directory.join("probe"));
    fs::create_dir_all(directory)
        .and_then(|()| File::create(&probe).map(drop))
        .and_then(|()| fs::remove_file(&probe))
        .map_err(|error| {
            FileError::io(
                directory,
                format_args!("cannot be written into: {}", plain(&error)),
            )
        })
}

/// Takes away what an earlier run has left under a name that this run will write when it is
/// through: if it does not come to that, nobody shall take the old file for its own.
pub fn take_away(path: &Path) -> Result<(), FileError> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(FileError::io(
            path,
            format_args!("an earlier run's cannot be taken away: {}", plain(&error)),
        )),
        _ => Ok(()),
    }
}

/// Makes the folder of a file, and proves that the file can be made there.
pub fn prepare_file(path: &Path) -> Result<(), FileError> {
    if path.is_dir() {
        return Err(FileError::io(path, "cannot be written: it is a folder"));
    }
    match path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty())
    {
        Some(folder) => prepare_directory(folder),
        None => prepare_directory(Path::new(".")),
    }
}

/// Makes a folder one writer's for as long as what is returned is kept; `who` the other one is, if
/// there is one.
pub fn claim(directory: &Path, who: &str) -> Result<File, FileError> {
    let file = File::open(directory).map_err(|error| FileError::io(directory, plain(&error)))?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(FileError::io(
            directory,
            format_args!("another {who} is writing there"),
        )),
        // Some network file systems have no locks: then it is up to the user.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// Takes away what processes that were killed had begun to write in a folder, which nobody else may
/// be writing into. What cannot be removed is in nobody's way.
pub fn sweep(directory: &Path) {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    for entry in entries.filter(|entry| is_temporary(&entry.file_name().to_string_lossy())) {
        let _ = fs::remove_file(entry.path());
    }
}

/// Whether a file's name is one of [`temporary_name`]'s.
fn is_temporary(name: &str) -> bool {
    let process = name.strip_suffix(".tmp").and_then(|n| n.rsplit_once('.'));
    let is_number = |n: &str| n.bytes().all(|b| b.is_ascii_digit());
    name.starts_with('.') && process.is_some_and(|(_, n)| is_number(n))
}

/// Hidden, beside the file it will become (a rename must not cross file systems), and told apart by
/// process so that two runs into one directory do not write into each other's.
fn temporary_name(path: &Path) -> PathBuf {
    let name = path
        .file_name()
        .map(|n| n.to_string_lossy().into_owned())
        .unwrap_or_default();
    path.with_file_name(format!(".{name}.{}.tmp", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.txt");
        write(&path, |w| w.write_all(b"first")).unwrap();
        let failed = write(&path, |w| {
            w.write_all(b"sec")?;
            Err(io::Error::other("disk full"))
        });
        assert!(failed.unwrap_err().to_string().contains("disk full"));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    }

    #[test]
    fn only_what_was_left_unfinished_is_swept_away() {
        let directory = tempfile::tempdir().unwrap();
        let left = temporary_name(&directory.path().join("a.npy"));
        for name in [left.as_path(), Path::new("a.npy"), Path::new(".mine.tmp")] {
            fs::write(directory.path().join(name), "x").unwrap();
        }
        sweep(directory.path());
        assert!(!left.exists());
        assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 2);
    }
}
