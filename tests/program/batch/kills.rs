//! Killed at any instant, a batch loses nothing.

use crate::workplace::workplace;

#[test]
fn killed_batches_go_on_without_loss() {
    let directory = workplace();
    crate::jobs::survive_kills(directory.path(), 20, 6);
}

/// A batch that is killed fifty times.
#[cfg(feature = "long-tests")]
#[test]
fn batches_killed_often() {
    let directory = workplace();
    crate::jobs::survive_kills(directory.path(), 20, 50);
}
