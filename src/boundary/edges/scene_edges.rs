//! The edges at which something may jump.
//!
//! Seen from a point o, an edge and o span a plane. If all triangles at the edge lie on one side of
//! that plane the surface ends there, as seen from o: the edge is a silhouette. If not, only the
//! shading may jump. That holds for borders, folds, and edges at which many triangles meet.

use crate::discontinuity::adjacency::Adjacency;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::texture_edges;
use crate::discontinuity::walk::{Bend, FLAT, bend_at};
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};
use std::ops::Range;

/// Height over length of a triangle that is a line for who looks.
const SLIVER: f64 = 1e-5;

/// An edge, and what hangs on it.
#[derive(Clone, Debug)]
pub struct SceneEdge {
    pub ends: [u32; 2],
    /// The third vertex of each triangle at it, in [`SceneEdges::thirds`].
    thirds: Range<u32>,
    /// What happens there if it is no silhouette.
    pub shading: Shading,
    /// Whether it is an acute edge of a body with shading normals.
    pub is_acute: bool,
    /// Unit normals of two of its triangles, for who asks what it may be a silhouette from.
    pub normals: [DVec3; 2],
    /// Its part in what jumps there: borders of several meshes may lie in one place.
    pub share: f64,
}

/// What becomes of the shading at an edge, where both sides are seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shading {
    /// Nothing jumps.
    GoesOn,
    Jumps,
    /// Only the plane of the triangles changes (`discontinuity::crossing`); how much that matters,
    /// up to one.
    Facets(f64),
}

impl Shading {
    /// How often it had better be looked at, beside silhouettes.
    pub fn importance(self) -> f64 {
        match self {
            Shading::GoesOn => 0.0,
            Shading::Jumps => 1.0,
            Shading::Facets(share) => share,
        }
    }

    /// Whether only what lies between the planes of two facets counts.
    pub fn is_facets(self) -> bool {
        matches!(self, Shading::Facets(_))
    }
}

/// All of a scene's edges that are no seams within a plane.
#[derive(Debug, Default)]
pub struct SceneEdges {
    pub edges: Vec<SceneEdge>,
    thirds: Vec<u32>,
}

impl SceneEdges {
    /// Those of the meshes for which `wanted` holds.
    pub fn new(geometry: &Geometry, adjacency: &Adjacency, wanted: impl Fn(usize) -> bool) -> Self {
        let mut own = Self::default();
        for mesh in 0..geometry.smooth.len() {
            let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m]);
            if first < end && wanted(mesh) {
                own.add_folds(geometry, adjacency, first..end);
                own.add_borders(geometry, adjacency, mesh);
            }
        }
        own.share_places(geometry);
        own
    }

    /// Gives borders of several meshes that lie in one place equal shares: each is drawn, and what
    /// jumps is seen beside each. Borders whose ends differ are not known to lie on one another.
    fn share_places(&mut self, geometry: &Geometry) {
        // Adding zero takes the sign from it.
        let bits = |v: u32| {
            (geometry.positions[v as usize] + Vec3::ZERO)
                .to_array()
                .map(f32::to_bits)
        };
        let place = |edge: &SceneEdge| {
            let [a, b] = edge.ends.map(bits);
            [a.min(b), a.max(b)]
        };
        let is_border = |edge: &&mut SceneEdge| edge.normals == [DVec3::ZERO; 2];
        let mut borders: Vec<_> = self.edges.iter_mut().filter(is_border).collect();
        borders.sort_by_cached_key(|edge| place(edge));
        for same in borders.chunk_by_mut(|a, b| place(a) == place(b)) {
            let share = 1.0 / same.len() as f64;
            same.iter_mut().for_each(|edge| edge.share = share);
        }
    }

    /// Edges that two triangles share.
    fn add_folds(&mut self, geometry: &Geometry, adjacency: &Adjacency, triangles: Range<u32>) {
        for triangle in triangles {
            for corner in 0..3 {
                let Some(across) = adjacency.across(triangle, corner) else {
                    continue;
                };
                if (across.triangle, across.corner) < (triangle, corner) {
                    continue;
                }
                let Bend {
                    squared_sine,
                    is_acute,
                    normals,
                    share,
                    is_torn,
                } = bend_at(geometry, triangle, corner, &across);
                let is_smooth =
                    geometry.smooth[geometry.mesh_of_triangle[triangle as usize] as usize];
                let is_seam = texture_edges::is_seam(geometry, triangle, corner, &across);
                let shading = match squared_sine {
                    _ if is_seam || (is_smooth && is_torn) => Shading::Jumps,
                    None => Shading::GoesOn,
                    Some(_) if is_smooth => Shading::Facets(share),
                    Some(_) => Shading::Jumps,
                };
                if shading == Shading::GoesOn && !is_acute {
                    continue;
                }
                let thirds = [
                    geometry.triangles[triangle as usize][(corner + 2) % 3],
                    geometry.triangles[across.triangle as usize][(across.corner + 2) % 3],
                ];
                let ends = ends(geometry, triangle, corner);
                self.push(ends, &thirds, shading, is_smooth && is_acute, normals);
            }
        }
    }

    /// Edges of one triangle, and of more than two. Slivers that hang on an edge are left out:
    /// probes look past them, and would find what jumps at that edge at the sliver's others, too.
    fn add_borders(&mut self, geometry: &Geometry, adjacency: &Adjacency, mesh: usize) {
        let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m]);
        let welded = geometry.welded(mesh);
        let weld = |v: u32| welded[(v - geometry.first_vertex[mesh]) as usize];
        let mut borders = Vec::new();
        for triangle in first..end {
            for corner in 0..3 {
                if adjacency.across(triangle, corner).is_none() && !is_sliver(geometry, triangle) {
                    let [a, b] = ends(geometry, triangle, corner).map(weld);
                    borders.push(([a.min(b), a.max(b)], triangle, corner));
                }
            }
        }
        borders.sort_unstable();
        for same in borders.chunk_by(|a, b| a.0 == b.0) {
            let third =
                |&(_, t, c): &([u32; 2], u32, usize)| geometry.triangles[t as usize][(c + 2) % 3];
            let thirds: Vec<u32> = same.iter().map(third).collect();
            let (_, triangle, corner) = same[0];
            let ends = ends(geometry, triangle, corner);
            // More than two triangles: what they look like on either side is for probes to say.
            let shading = if same.len() == 1 {
                Shading::GoesOn
            } else {
                Shading::Jumps
            };
            self.push(ends, &thirds, shading, false, [DVec3::ZERO; 2]);
        }
    }

    fn push(
        &mut self,
        ends: [u32; 2],
        thirds: &[u32],
        shading: Shading,
        is_acute: bool,
        normals: [DVec3; 2],
    ) {
        let first = self.thirds.len() as u32;
        self.thirds.extend_from_slice(thirds);
        self.edges.push(SceneEdge {
            ends,
            thirds: first..self.thirds.len() as u32,
            shading,
            is_acute,
            normals,
            share: 1.0,
        });
    }

    /// On which side of the plane through `o` and the edge its triangles lie, as the sign of F;
    /// `None` if they lie on both: then the surface goes on. `None` too if one lies in that plane,
    /// as a triangle does from each of its own points: that is their horizon
    /// (`boundary::edges::horizon`).
    pub fn side(&self, geometry: &Geometry, edge: &SceneEdge, o: DVec3) -> Option<f64> {
        let c = Boundary::Edge(edge.ends).normal(geometry, o);
        let flat = FLAT * c.length_squared();
        let at = |v: u32| geometry.positions[v as usize].as_dvec3();
        let [end, other] = edge.ends.map(at);
        let along = (other - end).normalize();
        let thirds = &self.thirds[edge.thirds.start as usize..edge.thirds.end as usize];
        let mut sides = thirds.iter().map(|&v| {
            let way = (at(v) - end).reject_from_normalized(along);
            let height = c.dot(way);
            (height * height > flat * way.length_squared()).then_some(height.signum())
        });
        let first = sides.next()??;
        sides.all(|side| side == Some(first)).then_some(first)
    }
}

/// Whether a triangle is so thin that probes beside its edges look past it.
fn is_sliver(geometry: &Geometry, triangle: u32) -> bool {
    let position = |v: u32| geometry.positions[v as usize].as_dvec3();
    let [a, b, c] = geometry.triangles[triangle as usize].map(position);
    let sides = [b - a, c - b, a - c].map(DVec3::length_squared);
    let longest_squared = sides.into_iter().fold(0.0, f64::max);
    (b - a).cross(c - a).length() < SLIVER * longest_squared
}

fn ends(geometry: &Geometry, triangle: u32, corner: usize) -> [u32; 2] {
    let vertices = geometry.triangles[triangle as usize];
    [vertices[corner], vertices[(corner + 1) % 3]]
}
