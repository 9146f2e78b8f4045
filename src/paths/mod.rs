//! Paths: how film samples lie, how paths are traced and stored, how they become an image.
//!
//! All of it is the rendering itself: estimators of what jumps are called through one seam and are
//! not named here.

pub mod at;
pub mod between_planes;
pub mod body_share;
pub mod bounce;
pub mod boundary_sample;
pub mod chain;
pub mod chain_relief;
pub mod chain_vertex;
pub mod counts;
pub mod dimensions;
pub mod drift_body;
pub mod environment;
pub mod estimator;
pub mod film;
pub mod integral;
pub mod integrator;
pub mod leaving;
pub mod light;
pub mod lobe_drift;
pub mod meeting;
pub mod moving;
pub mod radiance;
pub mod random;
pub mod rays;
pub mod relay;
pub mod relayed;
pub mod scene_view;
pub mod spread;
pub mod start;
pub mod store;
pub mod surface;
pub mod warp;
