//! What surfaces do with light: energy, reciprocity, and that all parts of the engine mean the same
//! BSDF.

mod beams;
mod energy;
mod extremes;
mod formulas;
mod layers;
mod reciprocity;
