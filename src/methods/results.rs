//! What runs give.

use super::statistics::Statistics;
use crate::gradient::terms::Terms;
use crate::picture::Image;
use crate::scene::parameters::Gradient;

/// What [`render`](super::render()) gives.
#[derive(Clone, Debug, Default)]
pub struct Rendering {
    pub image: Image,
    pub statistics: Statistics,
}

/// What [`forward`](super::forward()) gives.
#[derive(Clone, Debug, Default)]
pub struct ForwardGradient {
    pub image: Image,
    /// The derivative of every pixel along the direction.
    pub gradient: Image,
    /// The standard error of every number of `gradient`.
    pub stderr: Option<Image>,
    pub statistics: Statistics,
}

/// What [`backward`](super::backward()) gives.
#[derive(Debug)]
pub struct BackwardGradient {
    pub image: Image,
    pub gradient: Gradient,
    /// Independent estimates of the gradient, whose mean is `gradient`.
    pub groups: Vec<Gradient>,
    pub loss: f64,
    /// Whether few samples carry it.
    pub terms: Terms,
    pub statistics: Statistics,
}
