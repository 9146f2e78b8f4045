//! Which triangles share an edge, once coincident vertices are taken as one.

use crate::trace::geometry::Geometry;
use rayon::slice::ParallelSliceMut;

/// Across a half-edge lies no other triangle.
const NONE: u32 = u32::MAX;
/// More than two triangles meet there.
const MANY: u32 = u32::MAX - 1;

/// For each half-edge (3·triangle + corner: the edge from that corner to the next) its twin.
pub struct Adjacency {
    /// 2·(half-edge number) + (1 if both triangles run along the edge in the same direction, so
    /// that the surface's orientation flips across it), or [`NONE`] or [`MANY`].
    twin: Vec<u32>,
}

/// What lies across an edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Across {
    pub triangle: u32,
    /// The corner of that triangle at which the shared edge starts.
    pub corner: usize,
    /// Whether the other triangle is wound the other way round.
    pub flipped: bool,
}

impl Adjacency {
    /// Finds the twins of all half-edges, mesh by mesh. Vertices at bitwise equal positions count
    /// as one, so that seams of texture coordinates or normals are not taken for borders.
    pub fn new(geometry: &Geometry) -> Self {
        let mut twin = vec![NONE; 3 * geometry.triangles.len()];
        for mesh in 0..geometry.first_vertex.len() - 1 {
            link_mesh(geometry, mesh, &mut twin);
        }
        Self { twin }
    }

    /// The same after vertices of the meshes marked in `moved` have moved, which may weld or part
    /// them.
    pub fn with_moved(&self, geometry: &Geometry, moved: &[bool]) -> Self {
        let mut twin = self.twin.clone();
        for mesh in (0..moved.len()).filter(|&mesh| moved[mesh]) {
            let half_edge = |m: usize| 3 * geometry.first_triangle[m] as usize;
            twin[half_edge(mesh)..half_edge(mesh + 1)].fill(NONE);
            link_mesh(geometry, mesh, &mut twin);
        }
        Self { twin }
    }

    /// Whether the surface ends at the edge that starts at `corner`.
    pub fn is_border(&self, triangle: u32, corner: usize) -> bool {
        self.twin[3 * triangle as usize + corner] == NONE
    }

    /// The triangle across the edge that starts at `corner`, if there is exactly one.
    pub fn across(&self, triangle: u32, corner: usize) -> Option<Across> {
        let packed = self.twin[3 * triangle as usize + corner];
        (packed < MANY).then(|| {
            let half_edge = packed >> 1;
            Across {
                triangle: half_edge / 3,
                corner: (half_edge % 3) as usize,
                flipped: packed & 1 == 1,
            }
        })
    }
}

fn link_mesh(geometry: &Geometry, mesh: usize, twin: &mut [u32]) {
    let v0 = geometry.first_vertex[mesh] as usize;
    let (t0, t1) = (
        geometry.first_triangle[mesh] as usize,
        geometry.first_triangle[mesh + 1] as usize,
    );

    let welded = geometry.welded(mesh);
    // (edge as unordered pair, half-edge, direction), sorted so that an edge's half-edges stand
    // together.
    let mut edges: Vec<(u64, u32, bool)> = Vec::with_capacity(3 * (t1 - t0));
    for t in t0..t1 {
        let v = geometry.triangles[t].map(|v| welded[v as usize - v0]);
        for corner in 0..3 {
            let (a, b) = (v[corner], v[(corner + 1) % 3]);
            let key = (a.min(b) as u64) << 32 | a.max(b) as u64;
            edges.push((key, (3 * t + corner) as u32, a < b));
        }
    }
    edges.par_sort_unstable();
    for group in edges.chunk_by(|a, b| a.0 == b.0) {
        match *group {
            [_] => {}
            [(_, e, e_up), (_, f, f_up)] => {
                let flipped = (e_up == f_up) as u32;
                twin[e as usize] = f << 1 | flipped;
                twin[f as usize] = e << 1 | flipped;
            }
            _ => group.iter().for_each(|&(_, e, _)| twin[e as usize] = MANY),
        }
    }
}
