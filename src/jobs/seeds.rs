//! Seeds of the runs of a check or a study.

/// Parts the seeds of the runs; finite differences with the random numbers under test would share
/// their noise.
pub const SEED_STEP: u64 = 0x9e37_79b9_7f4a_7c15;
/// Those of finite differences begin here.
pub const FIRST_REFERENCE_SEED: usize = 1 << 20;

/// The seed of a run; the first is the user's own.
pub fn nth_seed(seed: u64, n: usize) -> u64 {
    seed.wrapping_add((n as u64).wrapping_mul(SEED_STEP))
}
