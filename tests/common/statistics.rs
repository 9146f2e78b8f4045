//! Means with standard errors over independent runs, and whether two kinds of runs agree.

// Not every test that has this module needs both.
#[allow(unused_imports)]
pub use warpath::statistics::{agreement::Agreement, estimate::Estimate};
