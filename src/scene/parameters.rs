//! Stand-in for the parameter registry, which another branch brings.

use super::{Scene, SceneDifferential};

/// One parameter of a scene.
#[derive(Clone, Debug)]
pub struct Parameter {
    pub key: String,
    pub shape: Vec<usize>,
    pub differentiable: bool,
    pub moves_visibility: bool,
}

/// Every parameter of the scene.
pub fn list(_scene: &Scene) -> Vec<Parameter> {
    Vec::new()
}

/// The parameter called `key`.
pub fn find(_scene: &Scene, key: &str) -> Result<Parameter, String> {
    Err(format!("{key} is not a parameter of this scene"))
}

/// The derivative with respect to `parameter`.
pub fn reduce(_scene: &Scene, _parameter: &Parameter, _gradient: &SceneDifferential) -> Vec<f32> {
    Vec::new()
}
