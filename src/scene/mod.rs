//! The scene as plain data, how it is loaded, and its tangents and cotangents.

mod beam;
mod camera;
pub mod data;
pub mod differential;
mod emitter;
pub mod error;
mod fineness;
mod input;
mod instance;
mod integrator;
pub mod iors;
mod load;
mod material;
pub mod mesh;
pub mod metals;
mod names;
pub mod nearest;
mod observer;
mod origin;
pub mod parameters;
mod reads;
mod rigid;
mod shape;
pub mod source;
mod spectrum;
mod texture;
pub mod vertex_normals;
mod xml;

pub use data::*;
pub use differential::{CameraDifferential, EnvironmentDifferential, SceneDifferential};
pub use error::{Place, SceneError};
pub use fineness::{RAY_OFFSET, unit};
pub use load::{load, load_from, load_to_list};
pub use origin::origin;
pub use vertex_normals::vertex_normals;
