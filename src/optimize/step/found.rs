//! What a step looks at, and what it finds.

use crate::methods::Statistics;
use crate::optimize::loss::LossEstimate;
use crate::picture::Image;

/// An image that a step looks at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Look {
    /// Index into the problem's views.
    pub view: usize,
    /// What the shapes cover, in place of the image itself.
    pub silhouette: bool,
}

/// With how many samples, and by which random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    pub step: u64,
    /// Of the derivative, a pixel.
    pub spp: u32,
    /// Of the image in the loss.
    pub loss_spp: u32,
}

/// What one step has found.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    pub loss: LossEstimate,
    /// What is added to the loss: total variation.
    pub penalty: f64,
    /// By variable: the gradient by its values, and the variance of each number of it.
    pub gradients: Vec<Vec<f64>>,
    pub variances: Vec<Vec<f64>>,
    /// The image of each view that was looked at.
    pub images: Vec<(usize, Image)>,
    pub statistics: Statistics,
}
