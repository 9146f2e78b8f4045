//! Files that leave the program, and the image and array files that users hand in: one module per
//! format.

pub mod atomic;
pub mod chart;
pub mod colormap;
mod error;
pub mod exr;
pub mod glyphs;
pub mod gradients;
pub mod npy;
pub mod picture;
pub mod png;
pub mod results;
pub mod tensors;
pub mod unfinished;

pub use crate::files::plain;
pub use error::FileError;
