//! The seam for several processes: who does which part of a step's work.
//!
//! A step is two rounds of units, in each of which a unit is the samples of one share of one view:
//! first the images of the loss, then the derivatives. What units give is added up in their order,
//! so that sums do not depend on who did them. All processes hold the same state and make the same
//! step from these sums.

use crate::jobs::failure::Failure;

/// Who works on a run.
///
/// All processes make the same calls in the same order, but for one that has failed, whose next
/// call must be [`agree`](Self::agree) with its failure.
pub trait Ranks {
    /// Does `work` for units `0..units`, or has it done elsewhere, and returns what each gave, in
    /// the order of the units: the same on every process.
    fn map(
        &self,
        units: usize,
        work: &mut dyn FnMut(usize) -> Result<Vec<f32>, Failure>,
    ) -> Result<Vec<Vec<f32>>, Failure>;

    /// Waits for all processes. Each says whether it can go on, and a fingerprint of what it has
    /// come to: if one cannot, or they differ, none goes on, for the reason of the first that
    /// cannot.
    fn agree(&self, own: Result<(), Failure>, fingerprint: &dyn Fn() -> u64)
    -> Result<(), Failure>;

    /// Whether this process writes files and speaks.
    fn writes(&self) -> bool;

    /// How many processes there are.
    fn count(&self) -> usize;
}

/// One process does all.
pub struct Alone;

impl Ranks for Alone {
    fn map(
        &self,
        units: usize,
        work: &mut dyn FnMut(usize) -> Result<Vec<f32>, Failure>,
    ) -> Result<Vec<Vec<f32>>, Failure> {
        (0..units).map(work).collect()
    }

    fn agree(&self, own: Result<(), Failure>, _: &dyn Fn() -> u64) -> Result<(), Failure> {
        own
    }

    fn writes(&self) -> bool {
        true
    }

    fn count(&self) -> usize {
        1
    }
}

/// Whether something went well, for [`Ranks::agree`].
pub fn outcome<T>(done: &Result<T, Failure>) -> Result<(), Failure> {
    done.as_ref().map(drop).map_err(Failure::clone)
}
