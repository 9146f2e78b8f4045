//! Where the radiance jumps on the film.

pub mod cell;
pub mod search;
pub mod weights;
