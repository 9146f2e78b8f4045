//! Where scene and mesh files come from: the disk, or memory in tests and fuzzing.

use super::error::SceneError;
use crate::files::{self, plain};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Reads whole files by path.
pub trait FileSource {
    /// All bytes of the file. `NotFound` if there is none, `IsADirectory` or `InvalidInput` if what
    /// is there is no regular file.
    fn read(&self, path: &Path) -> io::Result<Vec<u8>>;
    /// Whether something is at `path`.
    fn exists(&self, path: &Path) -> bool;
    /// One spelling for all the paths of a file, for finding includes that include themselves.
    fn canonical(&self, path: &Path) -> PathBuf {
        path.to_path_buf()
    }
}

/// The file system.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl FileSource for Disk {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        files::read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        // A path that cannot be looked at (permission) is left to `read`, which says why.
        !matches!(path.try_exists(), Ok(false))
    }

    fn canonical(&self, path: &Path) -> PathBuf {
        path.canonicalize().unwrap_or_else(|_| path.to_path_buf())
    }
}

/// Files held in memory.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl Memory {
    /// No file yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// With one more file, in place of one of the same path.
    pub fn with(mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) -> Self {
        self.files.insert(path.into(), bytes.into());
        self
    }
}

impl FileSource for Memory {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        let found = self.files.get(path).cloned();
        found.ok_or_else(|| io::ErrorKind::NotFound.into())
    }

    fn exists(&self, path: &Path) -> bool {
        self.files.contains_key(path)
    }
}

/// Reads `path`, telling a file that is not there (bad input) from one that cannot be read (I/O).
pub fn read_file(files: &dyn FileSource, path: &Path) -> Result<Vec<u8>, SceneError> {
    files.read(path).map_err(|source| {
        let file = path.display().to_string();
        match source.kind() {
            io::ErrorKind::NotFound => SceneError::Missing {
                what: format!("{file}: no such file"),
            },
            io::ErrorKind::InvalidInput | io::ErrorKind::IsADirectory => SceneError::Missing {
                what: format!("{file}: not a regular file"),
            },
            io::ErrorKind::NotADirectory | io::ErrorKind::InvalidFilename => SceneError::Missing {
                what: format!("{file}: no such file ({})", plain(&source)),
            },
            _ => SceneError::Io { file, source },
        }
    })
}

/// FNV-1a, 64 bits.
#[derive(Clone, Copy, Debug)]
pub struct Fnv1a(pub u64);

impl Default for Fnv1a {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fnv1a {
    /// Takes in more bytes.
    pub fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }
}
