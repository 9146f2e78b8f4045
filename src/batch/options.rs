//! How a batch is run, and who is told how it goes.

use super::queue::shard::{Shard, Split};
use super::results::line::ResultLine;
use super::results::manifest::Manifest;
use super::results::tally::Tally;
use crate::trace::Backend;
use std::path::PathBuf;

/// How a batch is run.
#[derive(Clone, Debug)]
pub struct Options {
    pub directory: PathBuf,
    pub resume: bool,
    pub threads: usize,
    pub memory_bytes: u64,
    pub shard: Option<Shard>,
    pub split: Split,
    /// What traces the rays.
    pub backend: Backend,
}

impl Options {
    /// What the folder holds the results of; `jobs` is a hash of the job file, and `count` how many
    /// of them are done here.
    pub fn manifest(&self, jobs: String, count: usize) -> Manifest {
        let (shard, shards) = self.shard.map_or((1, 1), |s| (s.index, s.count));
        Manifest {
            version: env!("CARGO_PKG_VERSION").into(),
            jobs,
            count: Some(count),
            shard,
            shards,
            split: self.split.name().into(),
            backend: self.backend.to_string(),
        }
    }

    /// The part of the jobs that is done here, if they are what is shared out.
    pub fn shard_of_jobs(&self) -> Option<Shard> {
        self.shard.filter(|_| self.split == Split::Jobs)
    }

    /// The part of every job's samples that is done here, if they are what is shared out.
    pub fn shard_of_samples(&self) -> Option<Shard> {
        self.shard.filter(|_| self.split == Split::Samples)
    }
}

/// Who is told how the batch goes. Several threads tell.
pub trait Watch: Sync {
    /// `total` jobs are to be run, or an unknown number; an earlier run has done `skipped`.
    fn begin(&self, total: Option<usize>, skipped: usize);
    /// Something has gone on: called often.
    fn advance(&self, tally: &Tally);
    /// A job has ended.
    fn ended(&self, result: &ResultLine, tally: &Tally);
    /// Whether the user wants to stop, and by which signal.
    fn signal(&self) -> Option<u8>;
}
