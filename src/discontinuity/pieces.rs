//! How large the things are that meshes consist of.

use crate::discontinuity::adjacency::Adjacency;
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
}

impl Pieces {
    pub fn new(geometry: &Geometry, adjacency: &Adjacency) -> Self {
        let mut of_vertex = vec![0; geometry.positions.len()];
        let mut spheres = Vec::new();
        let mut is_known = vec![false; geometry.triangles.len()];
        let mut rest = Vec::new();
        for first in 0..geometry.triangles.len() {
            if is_known[first] {
                continue;
            }
            let [mut low, mut high] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
            is_known[first] = true;
            rest.push(first as u32);
            while let Some(triangle) = rest.pop() {
                for (corner, &v) in geometry.triangles[triangle as usize].iter().enumerate() {
                    of_vertex[v as usize] = spheres.len() as u32;
                    let p = geometry.positions[v as usize].as_dvec3();
                    (low, high) = (low.min(p), high.max(p));
                    let across = adjacency.across(triangle, corner).map(|a| a.triangle);
                    rest.extend(across.filter(|&t| !is_known[t as usize]));
                    across.into_iter().for_each(|t| is_known[t as usize] = true);
                }
            }
            spheres.push(Sphere {
                centre: low.midpoint(high),
                radius: 0.5 * low.distance(high),
            });
        }
        Self { of_vertex, spheres }
    }

    /// The number of the piece that a vertex belongs to.
    pub fn number(&self, vertex: u32) -> u32 {
        self.of_vertex[vertex as usize]
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
