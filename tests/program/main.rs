//! The real program, as users and scripts meet it.

mod batch;
mod cli;
mod jobs;
mod memory;
mod optimize;
mod study;
mod workplace;
