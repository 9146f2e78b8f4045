//! The geometry of jumps: where visibility changes, how one boundary is found, and how fast it
//! moves.

pub mod adjacency;
pub mod arc;
pub mod between;
pub mod boundary;
pub mod crossing;
pub mod exit;
pub mod facets;
pub mod outline;
pub mod pencil;
pub mod pieces;
pub mod standing;
pub mod texture_edges;
pub mod walk;
