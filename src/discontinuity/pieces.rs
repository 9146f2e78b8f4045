//! How large the things are that meshes consist of.

use crate::discontinuity::adjacency::{Across, Adjacency};
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// A sphere around a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub centre: DVec3,
    pub radius: f64,
}

/// The *pieces* of meshes: triangles that hang together by their edges.
#[derive(Debug)]
pub struct Pieces {
    of_vertex: Vec<u32>,
    spheres: Vec<Sphere>,
    /// Of each mesh.
    shapes: Vec<Outlines>,
}

/// What tells whether a mesh may hide parts of itself.
#[derive(Clone, Debug, Default)]
struct Outlines {
    pieces: usize,
    /// Whether it bends away from its triangles' normals somewhere, and toward them.
    bends: [bool; 2],
}

/// The sine of an angle at which two triangles meet that counts as flat.
const FLAT: f64 = 1e-5;

impl Pieces {
    pub fn new(geometry: &Geometry, adjacency: &Adjacency) -> Self {
        let mut of_vertex = vec![0; geometry.positions.len()];
        let mut spheres = Vec::new();
        let mut shapes = vec![Outlines::default(); geometry.first_vertex.len() - 1];
        let mut is_known = vec![false; geometry.triangles.len()];
        let mut rest = Vec::new();
        for first in 0..geometry.triangles.len() {
            if is_known[first] {
                continue;
            }
            let shape = &mut shapes[geometry.mesh_of_triangle[first] as usize];
            shape.pieces += 1;
            let [mut low, mut high] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            is_known[first] = true;
            rest.push(first as u32);
            while let Some(triangle) = rest.pop() {
                for (corner, &v) in geometry.triangles[triangle as usize].iter().enumerate() {
                    of_vertex[v as usize] = spheres.len() as u32;
                    let p = geometry.positions[v as usize].as_dvec3();
                    (low, high) = (low.min(p), high.max(p));
                    let across = adjacency.across(triangle, corner);
                    if shape.bends != [true; 2] {
                        shape.bend(across.and_then(|a| bend(geometry, triangle, a)));
                    }
                    let across = across.map(|a| a.triangle);
                    rest.extend(across.filter(|&t| !is_known[t as usize]));
                    across.into_iter().for_each(|t| is_known[t as usize] = true);
                }
            }
            spheres.push(Sphere {
                centre: low.midpoint(high),
                radius: 0.5 * low.distance(high),
            });
        }
        Self {
            of_vertex,
            spheres,
            shapes,
        }
    }

    /// The number of the piece that a vertex belongs to.
    pub fn number(&self, vertex: u32) -> u32 {
        self.of_vertex[vertex as usize]
    }

    /// Whether parts of a mesh may hide one another from without: it is not convex.
    pub fn may_hide_itself(&self, mesh: u32) -> bool {
        let Outlines { pieces, bends } = self.shapes[mesh as usize];
        pieces > 1 || bends == [true; 2]
    }

    /// How many there are.
    pub fn count(&self) -> usize {
        self.spheres.len()
    }

    /// A sphere around the piece that a vertex belongs to.
    pub fn around(&self, vertex: u32) -> Sphere {
        self.spheres[self.number(vertex) as usize]
    }
}

impl Outlines {
    fn bend(&mut self, sine: Option<f64>) {
        let Some(sine) = sine else { return };
        self.bends[0] |= sine < -FLAT;
        self.bends[1] |= sine > FLAT;
    }
}

/// The sine of the angle by which the triangle across an edge rises above a triangle's plane;
/// `None` where they are wound differently, or one has no area.
fn bend(geometry: &Geometry, triangle: u32, across: Across) -> Option<f64> {
    if across.flipped {
        return None;
    }
    let corners = |t: u32| {
        let corners = geometry.triangles[t as usize];
        corners.map(|v| geometry.positions[v as usize].as_dvec3())
    };
    let [p, q, r] = corners(triangle);
    let other = corners(across.triangle);
    let [a, b, apex] = [0, 1, 2].map(|i| other[(across.corner + i) % 3]);
    let n = (q - p).cross(r - p).normalize();
    let height = (b - a).cross(apex - a).length() / (b - a).length();
    let sine = n.dot(apex - a) / height;
    sine.is_finite().then_some(sine)
}
