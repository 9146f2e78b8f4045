//! `warpath batch` and `warpath merge`, as users and scripts meet them.

mod alone;
mod bad_lines;
mod disk;
#[path = "../common/jobs.rs"]
mod jobs;
mod kills;
mod memory;
mod resume;
mod schema;
mod shards;
mod stream;
mod values;
#[path = "../cli/workplace.rs"]
#[allow(dead_code)]
mod workplace;
