//! Killed at any instant, a batch loses nothing.

use crate::workplace::workplace;

/// `make test-long` kills more often.
#[test]
fn killed_batches_go_on_without_loss() {
    let directory = workplace();
    crate::jobs::survive_kills(directory.path(), 20, 6);
}
