//! Where the radiance that arrives in a lobe jumps.

mod bounce;
mod cell;
pub mod drift;
pub mod families;
pub mod line;
mod met;
pub mod packet;
mod relief;
mod rims;
pub mod search;
mod shadows;
pub mod vertex;
mod walls;
