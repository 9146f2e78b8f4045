//! Statistics of estimates: how sure they are, and how far they are from each other.

pub mod comparison;
pub mod replicates;
