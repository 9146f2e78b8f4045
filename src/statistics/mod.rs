//! Statistics of estimates: how sure they are, and how far they are from each other.

pub mod agreement;
pub mod bias;
pub mod comparison;
pub mod concentration;
pub mod estimate;
pub mod image_mean;
pub mod replicates;
pub mod sigmas;
pub mod tradeoff;
