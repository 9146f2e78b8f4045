//! Triangle meshes: from files and from formulas, checked, and placed in the world.

mod finish;
pub mod obj;
pub mod ply;
mod ply_attributes;
mod ply_record;
pub(super) mod primitives;
pub(super) mod round;
pub mod serialized;

pub(super) use finish::{Placement, finish};

use glam::{Vec2, Vec3};

/// A mesh as its file has it, in object space.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RawMesh {
    /// Finite.
    pub positions: Vec<Vec3>,
    /// Indices in range; polygons already cut into triangles.
    pub triangles: Vec<[u32; 3]>,
    /// One a vertex, of any length, if the file has them.
    pub normals: Option<Vec<Vec3>>,
    /// One a vertex and finite, if the file has them: as they are written, not flipped.
    pub uvs: Option<Vec<Vec2>>,
    /// Each name once.
    pub attributes: Vec<Attribute>,
}

/// What every vertex, or every triangle, has one of.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// As `mesh_attribute` asks for it: `vertex_color`, `face_weight`.
    pub name: String,
    /// 3 for colours, 1 for numbers.
    pub channels: usize,
    /// Anything that the file says; a number stands there three times.
    pub values: Vec<[f32; 3]>,
}

impl Attribute {
    /// Whether it belongs to triangles, not to vertices.
    pub fn is_of_faces(&self) -> bool {
        is_of_faces(&self.name)
    }
}

/// Whether an attribute of that name belongs to triangles.
pub fn is_of_faces(name: &str) -> bool {
    name.starts_with("face_")
}

/// What is wrong with a mesh file, without the file's name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MeshError {
    /// `:line`, `, face 12`, `, vertex 3`, or nothing.
    pub at: String,
    /// What is wrong, and what would be right.
    pub what: String,
}

impl MeshError {
    fn new(at: impl Into<String>, what: impl Into<String>) -> Self {
        Self {
            at: at.into(),
            what: what.into(),
        }
    }
}

/// Cuts a polygon into triangles that share its first corner.
fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    let rest = corners.get(1..).unwrap_or_default();
    rest.windows(2).map(|pair| [corners[0], pair[0], pair[1]])
}
