//! Files that users name. Only regular ones are read: a device or a pipe may never end.

use crate::room;
use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

/// A regular file that is open. It is taken to be as long as it was when it was opened.
#[derive(Debug)]
pub struct Regular {
    file: File,
    bytes: u64,
}

impl Regular {
    /// Opens a file; `InvalidInput` if what is there is no regular one.
    pub fn open(path: &Path) -> io::Result<Self> {
        // Before it is opened: opening a pipe waits for its other end.
        let about = fs::metadata(path)?;
        if !about.is_file() {
            return Err(io::Error::new(
                io::ErrorKind::InvalidInput,
                "not a regular file",
            ));
        }
        Ok(Self {
            file: File::open(path)?,
            bytes: about.len(),
        })
    }

    /// Its length.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    /// The first bytes, `most` at most.
    pub fn start(&self, most: u64) -> io::Result<Vec<u8>> {
        self.part(0, self.bytes.min(most))
    }

    /// All bytes.
    pub fn all(&self) -> io::Result<Vec<u8>> {
        self.part(0, self.bytes)
    }

    /// A reader of what begins at byte `from`: one at a time.
    pub fn from(&self, from: u64) -> io::Result<impl Read> {
        let mut file = &self.file;
        file.seek(SeekFrom::Start(from))?;
        Ok(file.take(self.bytes.saturating_sub(from)))
    }

    fn part(&self, from: u64, bytes: u64) -> io::Result<Vec<u8>> {
        let mut part = room::empty(usize::try_from(bytes).unwrap_or(usize::MAX))?;
        self.from(from)?.take(bytes).read_to_end(&mut part)?;
        Ok(part)
    }
}

/// All bytes of a regular file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    Regular::open(path)?.all()
}

/// Whether the user has named something that is no file, rather than the system having failed.
pub fn is_misnamed(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::NotFound
            | io::ErrorKind::NotADirectory
            | io::ErrorKind::InvalidFilename
            | io::ErrorKind::InvalidInput
            | io::ErrorKind::IsADirectory
    )
}

/// The operating system's sentence without the error number that Rust appends.
pub fn plain(error: &io::Error) -> String {
    let text = error.to_string();
    match text.find(" (os error") {
        Some(end) => text[..end].to_string(),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(unix)]
    fn only_regular_files_are_opened() {
        for other in ["/dev/zero", "/dev/null", "/"] {
            let error = Regular::open(Path::new(other)).unwrap_err();
            assert_eq!(error.to_string(), "not a regular file", "{other}");
            assert!(is_misnamed(&error));
        }
    }

    #[test]
    fn parts_end_where_the_file_does() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a");
        fs::write(&path, b"abcdef").unwrap();
        let file = Regular::open(&path).unwrap();
        assert_eq!(file.start(2).unwrap(), b"ab");
        assert_eq!(file.start(9).unwrap(), b"abcdef");
        let mut rest = Vec::new();
        file.from(4).unwrap().read_to_end(&mut rest).unwrap();
        assert_eq!(rest, b"ef");
        assert_eq!(file.bytes(), 6);
        assert_eq!(file.all().unwrap(), b"abcdef");
    }
}
