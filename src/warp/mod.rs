//! Holding discontinuities still: which point to follow, and how fast the integrand's jumps move.

pub mod adjacency;
pub mod boundary;
pub mod crossing;
pub mod ink;
pub mod resolve;
pub mod walk;
