//! Pure functions over lanes, written once: the build derives their adjoints from these sources.
//!
//! Every `pub fn` here is branch-free and keeps to the subset that `src/adjoint/transform.rs`
//! documents.

pub mod bsdf;
pub mod camera;
pub mod frame;
pub mod fresnel;
pub mod layered;
pub mod light;
pub mod microfacet;
pub mod normal;
pub mod relief;
pub mod silhouette;
pub mod triangle;
