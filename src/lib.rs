//! Warpath: gradients of path-traced images on the CPU, through visibility.
//!
//! Data flows one way, and a test holds the modules to it:
//! `lanes → scene → trace → kernels → warp → paths → gradient → methods → output → cli`.

pub mod cli;
pub mod methods;
pub mod output;
pub mod scene;
