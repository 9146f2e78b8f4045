//! Where the radiance that arrives in a lobe jumps.

mod bounce;
pub mod families;
pub mod line;
pub mod packet;
pub mod search;
mod shadows;
pub mod vertex;
