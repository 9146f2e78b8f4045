//! Where what a delta light brings ends on what is seen along a line over a lobe.

use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Shadow;
use glam::DVec3;

/// Shadows, and surfaces on which beams end, are taken to be met with this chance at least: it
/// bounds the weight of their ends.
pub const SMALLEST_CHANCE: f64 = 1e-3;

/// The end of a shadow, or of a beam.
pub struct Met {
    pub shadow: Shadow,
    pub boundary: Boundary,
    pub direction: DVec3,
    /// Where what the light brings is looked at: there, or a little beside.
    pub looked_at: DVec3,
    /// What the light's radiance is multiplied with: +1 if it is hidden beyond, −1 if before, over
    /// the chance of finding it.
    pub jump: f64,
}
