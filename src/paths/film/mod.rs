//! The film: the camera's rays, how samples lie, how they become pixels.

pub mod camera;
pub mod density;
pub mod drift;
pub mod edge_on;
pub mod facet_paths;
pub mod filter;
pub mod lattice;
pub mod node_hits;
mod stretches;
pub mod tile;
pub mod tiling;
