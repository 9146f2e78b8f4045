//! What meshes need to be moved vertex by vertex.

pub mod intersections;
pub mod large_steps;
pub mod remesh;
pub mod watch;
pub mod weld;
