//! The scene file as a tree of plugins with typed properties: everything that is XML and not yet
//! scene.

mod file;
mod limits;
mod plugins;
mod positions;
mod properties;
mod property;
mod reader;
mod references;
mod substitution;
mod transform;
mod unsupported;
mod values;

pub(super) use properties::{Child, Object, Tree};
pub(super) use reader::read_tree;
