//! Where something begins to hide the environment.

pub mod constant;
pub mod map;
