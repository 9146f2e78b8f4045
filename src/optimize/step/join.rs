//! Finding the other processes of a run.

use super::launch::Launch;
#[cfg(feature = "mpi")]
use super::message_passing::MessagePassing;
use super::ranks::{Alone, Ranks};
use crate::jobs::failure::Failure;

/// Those that a launcher has started with this process, or this one alone.
pub fn join() -> Result<Box<dyn Ranks>, Failure> {
    match Launch::of(&|name| std::env::var(name).ok()) {
        None => Ok(Box::new(Alone)),
        Some(launch) => start(&launch),
    }
}

#[cfg(feature = "mpi")]
fn start(launch: &Launch) -> Result<Box<dyn Ranks>, Failure> {
    Ok(Box::new(MessagePassing::start(launch)?))
}

#[cfg(not(feature = "mpi"))]
fn start(launch: &Launch) -> Result<Box<dyn Ranks>, Failure> {
    Err(Failure::Usage(format!(
        "{} has started {} processes, and each would do the whole run and write the same files: this warpath is \
         built without MPI; build it with `cargo build --release --features mpi`, or start one process",
        launch.launcher, launch.processes
    )))
}
