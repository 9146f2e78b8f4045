//! The scene as plain data, and its tangents and cotangents.

pub mod data;
pub mod differential;

pub use data::*;
pub use differential::{CameraDifferential, SceneDifferential};

pub mod parameters;

/// Stand-in for the loader.
pub fn load(path: &std::path::Path, _defines: &[(String, String)]) -> Result<Scene, String> {
    Err(format!("{}: scenes cannot be loaded yet", path.display()))
}
