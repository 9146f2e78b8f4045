//! What meshes need to be moved vertex by vertex.

pub mod large_steps;
pub mod watch;
pub mod weld;
