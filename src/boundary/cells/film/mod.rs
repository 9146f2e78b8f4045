//! Where the radiance jumps on the film.

pub mod cell;
mod contact;
pub mod crowds;
mod detail;
pub mod drift;
mod looks;
mod pictures;
mod piece;
mod rims;
pub mod search;
mod shadow_border;
mod shadows;
mod terminators;
pub mod weights;
