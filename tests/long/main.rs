//! What the short tests leave out: more samples, longer paths, more kinds of motion. `make test-long` runs it.

#[path = "../common/mod.rs"]
mod common;
mod comparison;

/// Memory does not grow from 64 to 1024 samples.
#[test]
fn memory_at_many_samples() {
    common::memory::stays_small(&[64, 256, 1024], 3);
}
