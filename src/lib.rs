//! Warpath: gradients of path-traced images on the CPU, through visibility.
//!
//! Data flows one way, and a test holds the modules to it:
//! `room → files → lanes → picture → statistics → scene → trace → kernels → adjoint →
//! discontinuity → paths → gradient and boundary, which do not know each other → methods →
//! output → jobs → bench → batch, optimize and study → cli`.

pub mod adjoint;
pub mod batch;
pub mod bench;
pub mod boundary;
pub mod cli;
pub mod discontinuity;
pub mod files;
pub mod gradient;
pub mod jobs;
pub mod kernels;
pub mod lanes;
pub mod methods;
pub mod optimize;
pub mod output;
pub mod paths;
pub mod picture;
pub mod room;
pub mod scene;
pub mod statistics;
pub mod study;
pub mod trace;
pub mod warp;
