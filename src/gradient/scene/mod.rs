//! Derivatives of the scene: what moves forward, what is summed backward.

pub mod backward;
pub mod camera_ray;
pub mod forward;
pub mod normals;
mod sparse;
pub mod wanted;
