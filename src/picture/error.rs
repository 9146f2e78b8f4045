//! Why a picture could not be read.

use crate::files::{self, plain};
use crate::room::NoRoom;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Why a picture could not be read: one sentence that begins with the file's name.
#[derive(Debug, Error)]
pub enum PictureError {
    /// There is no such file, or what is in it is no picture that can be read.
    #[error("{}: {what}", .file.display())]
    Contents {
        /// As it was named.
        file: PathBuf,
        /// What is wrong, and what would be right.
        what: String,
    },
    /// The file is there and cannot be read.
    #[error("{}: {}", .file.display(), plain(.source))]
    Io {
        /// As it was named.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl PictureError {
    /// Whether the system failed (exit code 4) rather than the input being bad (exit code 3).
    pub fn is_io(&self) -> bool {
        matches!(self, PictureError::Io { .. })
    }

    pub(super) fn contents(file: &Path, what: impl Into<String>) -> Self {
        PictureError::Contents {
            file: file.to_path_buf(),
            what: what.into(),
        }
    }
}

/// All bytes of a regular file.
pub(super) fn read_file(file: &Path) -> Result<Vec<u8>, PictureError> {
    files::read(file).map_err(|source| match source {
        source if !files::is_misnamed(&source) => PictureError::Io {
            file: file.to_path_buf(),
            source,
        },
        source => PictureError::contents(
            file,
            match source.kind() {
                io::ErrorKind::InvalidInput => "not a regular file",
                _ => "no such file",
            },
        ),
    })
}

/// Why the bytes of a file did not become a picture.
#[derive(Debug)]
pub(super) enum Fault {
    /// What is wrong with them.
    Contents(String),
    NoRoom(NoRoom),
}

impl Fault {
    /// The same of `file`.
    pub fn of(self, file: &Path) -> PictureError {
        match self {
            Fault::Contents(what) => PictureError::contents(file, what),
            Fault::NoRoom(error) => PictureError::Io {
                file: file.to_path_buf(),
                source: error.into(),
            },
        }
    }
}

impl From<String> for Fault {
    fn from(what: String) -> Self {
        Fault::Contents(what)
    }
}

impl From<&str> for Fault {
    fn from(what: &str) -> Self {
        Fault::Contents(what.into())
    }
}

impl From<NoRoom> for Fault {
    fn from(error: NoRoom) -> Self {
        Fault::NoRoom(error)
    }
}
