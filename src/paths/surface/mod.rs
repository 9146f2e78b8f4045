//! Surfaces: where rays end, what is there, and where paths go on.

pub mod carried;
pub mod choice;
pub mod interface;
pub mod kinds;
pub mod layered_sample;
pub mod layers;
pub mod lobe_sample;
pub mod materials;
pub mod microfacet_sample;
pub mod parts;
pub mod relief;
pub mod rough_transmission;
pub mod texture;
pub mod vertex;
pub mod world_bounce;
