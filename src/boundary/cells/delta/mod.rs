//! The shadows of delta lights: where along a line of rays they end on what the rays see.
//!
//! On a line over a light or a lobe what jumps is what a point sees. Here it is what many points
//! are lit by: the *receivers*, where the line's rays end. From two of them a delta light is seen
//! along two rays that meet in it, so that the walk to the silhouette between them is the same,
//! with the light for its origin (docs/method.md, 6).

pub mod follow;
pub mod receiver;
pub mod rim;
pub mod value;
