//! Pure functions over lanes, written once: the build derives their adjoints from these sources.
//!
//! Every `pub fn` here is branch-free and keeps to the subset that `src/adjoint/transform` documents.

pub mod triangle;
