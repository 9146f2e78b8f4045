//! Where the radiance that arrives in a lobe jumps.

mod bounce;
mod cell;
pub mod families;
mod frames;
pub mod line;
mod met;
pub mod packet;
pub mod search;
mod shadows;
pub mod vertex;
