//! The scene as plain data, and its tangents and cotangents.

pub mod data;
pub mod differential;

pub use data::*;
pub use differential::{CameraDifferential, SceneDifferential};
