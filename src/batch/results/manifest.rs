//! `batch.json`: what a folder holds the results of, for `merge` and `--resume`.

use crate::jobs::failure::Failure;
use crate::jobs::id::MANIFEST;
use crate::output::{FileError, atomic};
use serde::{Deserialize, Serialize};
use std::io::Write;
use std::path::Path;

/// A batch, or one shard of it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Manifest {
    pub version: String,
    /// A hash of the job file.
    pub jobs: String,
    /// Jobs of it that are this shard's: with as many results it is finished. Earlier versions did
    /// not write it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<usize>,
    /// From 1 to `shards`.
    pub shard: u32,
    pub shards: u32,
    /// `jobs` or `samples`.
    pub split: String,
    /// What traced the rays.
    pub backend: String,
}

impl Manifest {
    /// Writes it; a batch that is resumed must be the same shard as before. Jobs may have been
    /// added since.
    pub fn write(&self, directory: &Path, resumes: bool) -> Result<(), Failure> {
        if resumes && directory.join(MANIFEST).exists() {
            let before = Self::read(directory)?;
            if (before.shard, before.kind()) != (self.shard, self.kind()) {
                return Err(Failure::Usage(format!(
                    "{} holds {before}, not {self}: choose another -o",
                    directory.display()
                )));
            }
        }
        let text = serde_json::to_string_pretty(self).unwrap_or_default() + "\n";
        let path = directory.join(MANIFEST);
        Ok(atomic::write_durably(&path, |file| {
            file.write_all(text.as_bytes())
        })?)
    }

    /// What all shards of a batch have in common, besides their jobs.
    pub fn kind(&self) -> (&str, u32, &str, &str) {
        (&self.version, self.shards, &self.split, &self.backend)
    }

    /// Reads that of a folder.
    pub fn read(directory: &Path) -> Result<Self, Failure> {
        let path = directory.join(MANIFEST);
        let text = std::fs::read(&path).map_err(|error| FileError::unread(&path, &error))?;
        serde_json::from_slice(&text)
            .map_err(|error| FileError::contents(&path, format!("not a batch's: {error}")).into())
    }
}

impl std::fmt::Display for Manifest {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "shard {}/{} by {} of warpath {} on {}",
            self.shard, self.shards, self.split, self.version, self.backend
        )
    }
}
