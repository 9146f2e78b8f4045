//! An outline, from edge to edge.
//!
//! About a vertex of an outline, triangles that face the viewer lie between two of its edges, and
//! those that do not between the same two. That is asked of both kinds: where the outline branches,
//! each finds another edge, and it is taken to end there, whichever edge one comes from.

use crate::discontinuity::adjacency::Adjacency;
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Triangles about a vertex before it is given up.
const MOST_TRIANGLES: usize = 256;

/// An edge as a triangle has it: from this corner to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct HalfEdge {
    pub triangle: u32,
    pub corner: usize,
}

impl HalfEdge {
    /// Its vertices.
    pub fn ends(&self, geometry: &Geometry) -> [u32; 2] {
        let corners = geometry.triangles[self.triangle as usize];
        [corners[self.corner], corners[(self.corner + 1) % 3]]
    }
}

/// The corners of triangles that each vertex is.
#[derive(Debug)]
pub struct Corners {
    /// Of each vertex, where its corners begin; and their number.
    first: Vec<u32>,
    /// 3·triangle + corner.
    corners: Vec<u32>,
}

impl Corners {
    pub fn new(geometry: &Geometry) -> Self {
        let mut first = vec![0; geometry.positions.len() + 1];
        for &v in geometry.triangles.iter().flatten() {
            first[v as usize + 1] += 1;
        }
        for v in 1..first.len() {
            first[v] += first[v - 1];
        }
        let mut next = first.clone();
        let mut corners = vec![0; 3 * geometry.triangles.len()];
        for (corner, &v) in geometry.triangles.iter().flatten().enumerate() {
            corners[next[v as usize] as usize] = corner as u32;
            next[v as usize] += 1;
        }
        Self { first, corners }
    }

    /// An edge between two vertices of a triangle.
    pub fn edge(&self, geometry: &Geometry, [a, b]: [u32; 2]) -> Option<HalfEdge> {
        let [from, to] = [a, a + 1].map(|v| self.first[v as usize] as usize);
        self.corners[from..to].iter().find_map(|&corner| {
            let (triangle, at) = (corner / 3, corner as usize % 3);
            let corners = geometry.triangles[triangle as usize];
            let before = (at + 2) % 3;
            let corner = match (corners[(at + 1) % 3] == b, corners[before] == b) {
                (true, _) => at,
                (_, true) => before,
                _ => return None,
            };
            Some(HalfEdge { triangle, corner })
        })
    }
}

/// The edge with which the outline that is seen from `o` goes on, beyond the first vertex of one of
/// its edges or the second; and whether that starts there.
pub fn next(
    (geometry, adjacency): (&Geometry, &Adjacency),
    o: DVec3,
    edge: HalfEdge,
    beyond_first: bool,
) -> Option<(HalfEdge, bool)> {
    let HalfEdge { triangle, corner } = edge;
    let vertex = if beyond_first {
        corner
    } else {
        (corner + 1) % 3
    };
    let mesh = (geometry, adjacency);
    let found = about(mesh, o, (triangle, corner, vertex))?;
    let over = adjacency.across(found.0.triangle, found.0.corner);
    let Some(across) = adjacency.across(triangle, corner) else {
        let is_border = |edge: HalfEdge| adjacency.is_border(edge.triangle, edge.corner);
        return (is_border(edge) && is_border(found.0)).then_some(found);
    };
    let vertex = (across.corner + usize::from(beyond_first != across.flipped)) % 3;
    let (other, _) = about(mesh, o, (across.triangle, across.corner, vertex))?;
    let over = over?;
    (over.triangle == other.triangle && over.corner == other.corner).then_some(found)
}

/// The next edge of the outline, or the surface's border, about a corner of a triangle away from
/// one of its edges; and whether it starts at the corner.
fn about(
    (geometry, adjacency): (&Geometry, &Adjacency),
    o: DVec3,
    (mut triangle, mut edge, mut vertex): (u32, usize, usize),
) -> Option<(HalfEdge, bool)> {
    let faces = |triangle: u32| {
        let corners = geometry.triangles[triangle as usize];
        let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3() - o);
        p.dot((q - p).cross(r - p)) < 0.0
    };
    let mut facing = faces(triangle);
    for _ in 0..MOST_TRIANGLES {
        let starts = edge != vertex;
        let corner = if starts { vertex } else { (vertex + 2) % 3 };
        let found = HalfEdge { triangle, corner };
        let Some(across) = adjacency.across(triangle, corner) else {
            return Some((found, starts));
        };
        if faces(across.triangle) != (facing ^ across.flipped) {
            return Some((found, starts));
        }
        facing ^= across.flipped;
        triangle = across.triangle;
        edge = across.corner;
        vertex = (across.corner + usize::from(starts != across.flipped)) % 3;
    }
    None
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use glam::{Vec3, dvec3, vec3};

    /// One mesh, shaded flat.
    pub fn geometry(positions: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Geometry {
        Geometry {
            origin: Vec3::ZERO,
            mesh_of_triangle: vec![0; triangles.len()],
            first_vertex: vec![0, positions.len() as u32],
            first_triangle: vec![0, triangles.len() as u32],
            positions,
            triangles,
            normals: Vec::new(),
            uvs: Vec::new(),
            smooth: vec![false],
            patterns: vec![None],
            unit: 1.0,
        }
    }

    /// A body of eight triangles, one of them wound the other way round.
    fn octahedron() -> Geometry {
        let positions = [Vec3::X, Vec3::Y, Vec3::Z].into_iter();
        let positions = positions.flat_map(|p| [p, -p]).collect();
        let mut triangles = Vec::new();
        for x in [0, 1] {
            for y in [2, 3] {
                for z in [4, 5] {
                    let outward = (x + y + z) % 2 == 0;
                    triangles.push(if outward { [x, y, z] } else { [y, x, z] });
                }
            }
        }
        triangles[3].swap(0, 1);
        geometry(positions, triangles)
    }

    /// From edge to edge one comes back to the first, and the other way round by the same edges.
    #[test]
    fn outlines_close() {
        let geometry = octahedron();
        let adjacency = Adjacency::new(&geometry);
        let corners = Corners::new(&geometry);
        let o = dvec3(0.1, 0.2, 5.0);
        let around = [[0, 2], [2, 1], [1, 3], [3, 0]];
        let same = |edge: HalfEdge, ends: [u32; 2]| {
            let own = edge.ends(&geometry);
            own == ends || own == [ends[1], ends[0]]
        };
        for i in 0..4 {
            let edge = corners.edge(&geometry, around[i]).expect("an edge");
            for (to, end) in [((i + 1) % 4, around[i][1]), ((i + 3) % 4, around[i][0])] {
                let first = edge.ends(&geometry)[0] == end;
                let found = next((&geometry, &adjacency), o, edge, first);
                let (found, starts) = found.expect("the outline goes on");
                assert!(same(found, around[to]), "{i}: {found:?}");
                assert_eq!(found.ends(&geometry)[usize::from(!starts)], end);
            }
        }
    }

    /// The border of a sheet is its outline; two outlines that meet in a vertex end there.
    #[test]
    fn outlines_end_where_they_branch() {
        let sheet = |z: f32| [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| vec3(x, y, z));
        let o = dvec3(0.2, 0.2, 5.0);
        let go = |geometry: &Geometry, ends: [u32; 2]| {
            let adjacency = Adjacency::new(geometry);
            let edge = Corners::new(geometry).edge(geometry, ends)?;
            let first = edge.ends(geometry)[0] == ends[1];
            next((geometry, &adjacency), o, edge, first)
        };
        let one = geometry(sheet(0.0).to_vec(), vec![[0, 1, 2]]);
        assert!(go(&one, [0, 1]).is_some());
        // Folded over the edge from 0 to 1: there it is an outline, and at its sides there are
        // borders.
        let mut folded = sheet(0.0).to_vec();
        folded.push(vec3(0.0, 1.0, -0.5));
        let folded = geometry(folded, vec![[0, 1, 2], [1, 0, 3]]);
        assert!(go(&folded, [0, 1]).is_none());
        assert!(go(&folded, [2, 0]).is_none());
    }
}
