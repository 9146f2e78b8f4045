//! Scenes as they are read: what is in them, what is refused, and that they look as they do
//! elsewhere.

mod bad_input;
mod loading;
mod materials;
mod paper_figures;
mod slender;
mod textures;
