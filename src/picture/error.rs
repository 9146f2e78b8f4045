//! Why a picture could not be read.

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
    #[error("{}: {source}", .file.display())]
    Io {
        /// As it was named.
        file: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

impl PictureError {
    /// Whether the world failed (exit code 4) rather than the input being bad (exit code 3).
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

/// All bytes of a regular file. A device or a pipe may never end.
pub(super) fn read_file(file: &Path) -> Result<Vec<u8>, PictureError> {
    let bytes = std::fs::metadata(file).and_then(|about| {
        let read = || std::fs::read(file).map(Some);
        about.is_file().then(read).unwrap_or(Ok(None))
    });
    match bytes {
        Ok(Some(bytes)) => Ok(bytes),
        Ok(None) => Err(PictureError::contents(file, "not a regular file")),
        Err(source) => match source.kind() {
            io::ErrorKind::NotFound
            | io::ErrorKind::NotADirectory
            | io::ErrorKind::InvalidFilename => Err(PictureError::contents(file, "no such file")),
            _ => Err(PictureError::Io {
                file: file.to_path_buf(),
                source,
            }),
        },
    }
}
