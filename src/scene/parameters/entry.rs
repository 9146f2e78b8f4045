//! One key of a scene, before its parameter is made.

use super::target::Target;

/// A parameter before its present value is looked up, which for a mesh takes time.
pub(super) struct Entry {
    pub key: String,
    pub aliases: Vec<String>,
    pub shape: Vec<usize>,
    pub target: Option<Target>,
    /// Of parameters without a target.
    pub fixed: Fixed,
    /// Why there is no target, if more can be said than that there is none.
    pub refusal: Option<&'static str>,
}

/// Listed, but not differentiable.
pub(super) enum Fixed {
    None,
    Faces(usize),
    Normals(usize),
    Uvs(usize),
    Numbers(Vec<f64>),
}

impl Entry {
    pub fn of(key: String, shape: &[usize], target: Target) -> Self {
        Self {
            key,
            aliases: Vec::new(),
            shape: shape.to_vec(),
            target: Some(target),
            fixed: Fixed::None,
            refusal: None,
        }
    }

    pub fn fixed(key: String, shape: &[usize], fixed: Fixed) -> Self {
        Self {
            key,
            aliases: Vec::new(),
            shape: shape.to_vec(),
            target: None,
            fixed,
            refusal: None,
        }
    }

    /// Numbers that cannot be differentiated.
    pub fn numbers(key: String, shape: &[usize], numbers: Vec<f64>) -> Self {
        Self::fixed(key, shape, Fixed::Numbers(numbers))
    }
}
