//! `warpath batch` and `warpath merge`.

mod alone;
mod bad_lines;
mod disk;
mod kills;
mod memory;
mod merges;
mod own_folders;
mod resume;
#[cfg(feature = "long-tests")]
mod schedulers;
mod schema;
mod shards;
mod stream;
mod unfinished_shards;
mod values;
