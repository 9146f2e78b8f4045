//! Estimators of what jumps: the boundary terms of the gradient.

pub mod cells;
pub mod clearance;
pub mod edges;
pub mod inclusion;
pub mod inclusion_by_walks;
pub mod light_samples;
pub mod mixture;
pub mod occlusion;
pub mod probe;
pub mod search_scene;
pub mod shadows;
pub mod surroundings;
