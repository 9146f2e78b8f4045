//! Along a path: forward from the camera, backward to it.

pub mod backward;
pub mod bars;
mod drift_backward;
mod drift_forward;
pub mod forward;
mod made_of_backward;
mod relay_backward;
mod relay_forward;
mod relief_backward;
mod relief_forward;
mod rest_backward;
mod rest_forward;
mod surface_backward;
