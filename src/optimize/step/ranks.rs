//! The seam for several processes: who does which part of a step's work.
//!
//! A step is two rounds of units, in each of which a unit is the samples of one share of one view:
//! first the images of the loss, then the derivatives. What units give is added up in their order,
//! so that sums do not depend on who did them. All processes hold the same state and make the same
//! step from these sums.

use crate::jobs::failure::Failure;

/// Who works on a run.
pub trait Ranks {
    /// Does `work` for units `0..units`, or has it done elsewhere, and returns what each gave, in
    /// the order of the units: the same on every process.
    fn map(
        &self,
        units: usize,
        work: &mut dyn FnMut(usize) -> Result<Vec<f32>, Failure>,
    ) -> Result<Vec<Vec<f32>>, Failure>;

    /// Whether this process writes files and speaks.
    fn writes(&self) -> bool;
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

    fn writes(&self) -> bool {
        true
    }
}
