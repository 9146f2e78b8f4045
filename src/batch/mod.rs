//! Batches of jobs that lose nothing.

pub mod merge;
pub mod one_job;
pub mod options;
pub mod queue;
pub mod results;
pub mod run;
pub mod samples;
pub mod scenes;
pub mod shard_folders;
