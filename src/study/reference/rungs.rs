//! What a reference is made of.

/// The runs at each step, the widest first: number by number.
pub struct Rungs {
    pub steps: Vec<Vec<Vec<f32>>>,
    /// The brightest number of an image.
    pub brightest: f64,
}
