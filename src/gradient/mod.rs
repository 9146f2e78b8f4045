//! From stored paths to gradients: tangent and adjoint sweeps, their sums, and standard errors.

pub mod accumulator;
pub mod forward;
mod forward_crossings;
mod forward_delta_lights;
mod forward_lights;
pub mod motion;
pub mod normals;

pub mod reverse;
mod reverse_crossings;
mod reverse_delta_lights;
mod reverse_lights;
mod reverse_surface;
pub mod terms;
