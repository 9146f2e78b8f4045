//! Triangles in world space.

use glam::{DAffine3, Vec2, Vec3};

/// A triangle mesh in world space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// As in the file, or Mitsuba's default name.
    pub id: String,
    /// World space, already transformed.
    pub positions: Vec<Vec3>,
    /// What took the shape (or the instance's group) there.
    pub to_world: DAffine3,
    /// Counter-clockwise seen from outside, `flip_normals` already applied.
    pub triangles: Vec<[u32; 3]>,
    pub normals: Normals,
    /// Texture coordinates, one a vertex; empty if the mesh has none.
    pub uvs: Vec<Vec2>,
    /// Index into [`super::Scene::materials`].
    pub material: usize,
    /// Index into [`super::Scene::area_lights`].
    pub area_light: Option<usize>,
}

/// Meshes in a row that move as one: a shape, or an instance of several.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Body {
    pub first: usize,
    pub count: usize,
}

impl Body {
    /// The body of one mesh.
    pub fn of(mesh: usize) -> Self {
        Self {
            first: mesh,
            count: 1,
        }
    }

    /// Indices into [`super::Scene::meshes`].
    pub fn meshes(self) -> std::ops::Range<usize> {
        self.first..self.first + self.count
    }
}

/// How a mesh is shaded.
#[derive(Clone, Debug, Default)]
pub enum Normals {
    /// One geometric normal a triangle.
    #[default]
    Flat,
    /// Unit vertex normals read from the file: data of their own, which rigid motions carry along
    /// and which `vertex_positions` leaves alone. One a vertex.
    Given(Vec<Vec3>),
    /// Unit vertex normals computed from the positions (angle-weighted), so that they move with
    /// them. One a vertex; the values at the present positions.
    Computed(Vec<Vec3>),
}

impl Normals {
    /// The unit normal of each vertex, if shading is smooth.
    pub fn vertex(&self) -> Option<&[Vec3]> {
        match self {
            Normals::Flat => None,
            Normals::Given(n) | Normals::Computed(n) => Some(n),
        }
    }
}
