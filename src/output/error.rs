//! Why a file could not be written or read.

use crate::files::{self, plain};
use std::io;
use std::path::PathBuf;

/// Why a file could not be written or read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The disk or the permissions said no.
    #[error("{}: {what}", .path.display())]
    Io { path: PathBuf, what: String },
    /// The file's contents are not what is needed.
    #[error("{}: {what}", .path.display())]
    Contents { path: PathBuf, what: String },
}

impl FileError {
    /// A failure of the system while working on `path`.
    pub fn io(path: impl Into<PathBuf>, what: impl ToString) -> Self {
        Self::Io {
            path: path.into(),
            what: what.to_string(),
        }
    }

    /// What kept a file that the user named from being read.
    pub fn unread(path: impl Into<PathBuf>, error: &io::Error) -> Self {
        let what = plain(error);
        match files::is_misnamed(error) {
            true => Self::contents(path, what),
            false => Self::io(path, what),
        }
    }

    /// A fault in the file at `path`.
    pub fn contents(path: impl Into<PathBuf>, what: impl ToString) -> Self {
        Self::Contents {
            path: path.into(),
            what: what.to_string(),
        }
    }
}
