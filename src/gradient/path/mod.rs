//! Along a path: forward from the camera, backward to it.

pub mod backward;
pub mod forward;
mod surface_backward;
