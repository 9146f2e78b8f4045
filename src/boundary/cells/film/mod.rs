//! Where the radiance jumps on the film.

pub mod cell;
pub mod crowds;
pub mod drift;
pub mod search;
pub mod shadows;
mod terminators;
pub mod weights;
