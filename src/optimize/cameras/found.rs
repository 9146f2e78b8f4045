//! What a file says of a camera.

use super::lens::Lens;
use glam::DAffine3;
use std::path::PathBuf;

/// A camera with its picture.
pub struct Found {
    /// What the file calls its picture.
    pub named: PathBuf,
    /// Camera to world, with the axes used here.
    pub to_world: DAffine3,
    pub lens: Lens,
    pub picture: PathBuf,
    /// A picture of what counts, if the file or the configuration names one.
    pub mask: Option<PathBuf>,
}
