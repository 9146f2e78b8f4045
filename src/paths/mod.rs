//! Paths: how film samples lie, how paths are traced and stored, how they become an image.

pub mod bounce_cells;
pub mod camera;
pub mod film;
pub mod film_cells;
pub mod lattice;
pub mod light_cells;
pub mod lights;
pub mod occluders;
pub mod random;
pub mod store;
pub mod tile;
pub mod tracer;
