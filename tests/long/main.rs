//! What the short tests leave out: more samples, longer paths, more kinds of motion. `make test-long` runs it.

#[path = "../common/mod.rs"]
mod common;
mod comparison;
#[path = "../common/jobs.rs"]
mod jobs;
mod leaves;
mod mutations;
mod schedulers;
#[path = "../cli/workplace.rs"]
#[allow(dead_code)]
mod workplace;

/// Memory does not grow from 64 to 1024 samples.
#[test]
fn memory_at_many_samples() {
    common::memory::stays_small(&[64, 256, 1024], 3);
}

/// A batch that is killed fifty times.
#[test]
fn batches_killed_often() {
    let directory = workplace::workplace();
    jobs::survive_kills(directory.path(), 20, 50);
}

/// The whole program on input that was changed at random.
#[test]
fn promises_hold_whatever_is_given() {
    mutations::campaign(20_000);
}
