//! What jumps behind smooth surfaces: lines of rays are followed through chains (`paths::chain`).

mod border;
mod cuts;
mod deeper;
pub mod film;
pub mod follow;
mod frames;
pub mod lobe;
pub mod look;
pub mod search;
mod shadows;
