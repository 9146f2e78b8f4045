//! Jobs: what one computes, for the single commands too, and batches of them that lose nothing.

mod attachments;
pub mod direction;
pub mod failure;
mod folder;
mod intake;
pub mod job;
pub mod journal;
mod loaded;
pub mod manifest;
pub mod memory;
pub mod merge;
pub mod numbers;
pub mod pairs;
pub mod result;
pub mod run;
pub mod schema;
pub mod settings;
pub mod shard;
mod share;
mod source;
mod store;
mod stream;
mod sum;
pub mod summary;
mod task;
