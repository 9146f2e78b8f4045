//! Writing a file so that a reader, or a crash, never meets half of it.

pub use super::error::plain;

use super::FileError;
use super::unfinished::Unfinished;
use std::fs::{self, File};
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
}
