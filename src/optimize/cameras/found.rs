//! What a file says of a camera.

use super::lens::Lens;
use glam::DAffine3;
use std::path::PathBuf;

/// A camera with its picture.
pub struct Found {
    pub name: String,
    /// Camera to world, with the axes used here.
    pub to_world: DAffine3,
    pub lens: Lens,
    pub picture: PathBuf,
}
