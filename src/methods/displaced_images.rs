//! What a displaced scene looks like, for differences.

use crate::scene::Rgb;

/// The images of one displaced scene.
pub struct DisplacedImages {
    /// Of each group of samples.
    pub groups: Vec<Vec<Rgb>>,
    pub size: [usize; 2],
    /// Which of the differences it belongs to.
    pub difference: usize,
    /// That difference is the sum of its images times theirs.
    pub per_step: f64,
    /// The derivative is the sum of all images times theirs.
    pub weight: f64,
    /// Of the samples.
    pub share: f64,
}
