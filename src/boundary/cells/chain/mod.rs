//! What jumps behind smooth surfaces: lines of rays are followed through chains (`paths::chain`).

mod border;
mod cuts;
mod deeper;
pub mod film;
pub mod follow;
pub mod lobe;
pub mod look;
mod rims;
pub mod search;
mod shadows;
mod weights;
