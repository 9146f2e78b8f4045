//! Inverse rendering: from pictures to shape, pose, light and material.

pub mod cameras;
pub mod config;
pub mod loss;
pub mod optimizer;
pub mod problem;
pub mod results;
pub mod run;
pub mod shape;
pub mod step;
