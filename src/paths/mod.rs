//! Paths: how film samples lie, how paths are traced and stored, how they become an image.

pub mod bounce;
pub mod bounce_cells;
pub mod bounce_lines;
pub mod camera;
pub mod direct;
pub mod direct_sky;
pub mod environment;
mod even_sky;
pub mod film;
pub mod film_cells;
mod film_runs;
pub mod lattice;
pub mod light_cells;
pub mod lights;
pub mod materials;
pub mod microfacets;
pub mod occluders;
pub mod random;
pub mod rays;
pub mod rough_transmission;
pub mod sky;
pub mod sky_cells;
pub mod store;
pub mod surface;
pub mod texture;
pub mod tile;
pub mod tracer;
