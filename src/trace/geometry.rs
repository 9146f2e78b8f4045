//! All meshes of a scene one after another: what kernels gather from, eight or sixteen triangles at
//! a time.

use super::pattern::Pattern;
use crate::lanes::{LANES, Lane, V3};
use crate::scene::Scene;
use glam::{DVec3, Vec2, Vec3};

/// No triangle: the ray hit nothing.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// Vertices and triangles of the whole scene, numbered across meshes.
pub struct Geometry {
    /// About `origin`.
    pub positions: Vec<Vec3>,
    /// The point of the world that is (0, 0, 0) here.
    pub origin: Vec3,
    /// Vertices of each triangle, numbered across meshes.
    pub triangles: Vec<[u32; 3]>,
    /// The mesh of each triangle.
    pub mesh_of_triangle: Vec<u32>,
    /// Number of the first vertex of each mesh, and the total.
    pub first_vertex: Vec<u32>,
    /// Number of the first triangle of each mesh, and the total.
    pub first_triangle: Vec<u32>,
    /// Unit shading normal a vertex; empty if no mesh is smooth, zero for flat meshes.
    pub normals: Vec<Vec3>,
    /// Texture coordinates a vertex; empty if no mesh has them, zero for meshes without.
    pub uvs: Vec<Vec2>,
    /// Whether each mesh is shaded smoothly.
    pub smooth: Vec<bool>,
    /// The pictures on each mesh that has any.
    pub patterns: Vec<Option<Pattern>>,
    /// What rounding is told by besides a point's own coordinates: the largest coordinate of all,
    /// at most one.
    pub unit: f32,
}

impl Geometry {
    pub fn new(scene: &Scene) -> Self {
        Self::about(scene, crate::scene::origin(&scene.meshes))
    }

    /// With this origin.
    pub fn about(scene: &Scene, origin: Vec3) -> Self {
        let smooth: Vec<bool> = scene
            .meshes
            .iter()
            .map(|m| m.normals.vertex().is_some())
            .collect();
        let any_smooth = smooth.contains(&true);
        let any_uv = scene.meshes.iter().any(|m| !m.uvs.is_empty());
        let mut g = Self {
            positions: Vec::new(),
            origin,
            triangles: Vec::new(),
            mesh_of_triangle: Vec::new(),
            first_vertex: vec![0],
            first_triangle: vec![0],
            normals: Vec::new(),
            uvs: Vec::new(),
            smooth,
            patterns: scene.meshes.iter().map(|m| Pattern::of(scene, m)).collect(),
            unit: crate::scene::unit(&scene.meshes, origin),
        };
        for (index, mesh) in scene.meshes.iter().enumerate() {
            let base = g.positions.len() as u32;
            g.positions
                .extend(mesh.positions.iter().map(|p| *p - origin));
            g.triangles
                .extend(mesh.triangles.iter().map(|t| t.map(|v| v + base)));
            g.mesh_of_triangle.resize(g.triangles.len(), index as u32);
            if any_smooth {
                match mesh.normals.vertex() {
                    Some(normals) => g.normals.extend_from_slice(normals),
                    None => g.normals.resize(g.positions.len(), Vec3::ZERO),
                }
            }
            if any_uv {
                g.uvs.extend_from_slice(&mesh.uvs);
                g.uvs.resize(g.positions.len(), Vec2::ZERO);
            }
            g.first_vertex.push(g.positions.len() as u32);
            g.first_triangle.push(g.triangles.len() as u32);
        }
        g
    }

    /// The mesh that a vertex is of.
    pub fn mesh_of_vertex(&self, vertex: u32) -> u32 {
        self.first_vertex.partition_point(|&first| first <= vertex) as u32 - 1
    }

    /// What rounding grows with at a point: a length, of which single precision is 6e-8.
    pub fn room(&self, point: DVec3) -> f64 {
        point.abs().max_element() + f64::from(self.unit)
    }

    /// Whether vertices lie in the plane of a triangle, or no further off it than `most` times what
    /// rounding grows with there, besides the rounding of the farthest of them all.
    pub fn lie_in_plane(&self, vertices: &[u32], triangle: u32, most: f64) -> bool {
        let position = |v: u32| self.positions[v as usize].as_dvec3();
        let corners = self.triangles[triangle as usize];
        let rooms = vertices.iter().chain(&corners);
        let rooms = rooms.map(|&v| self.room(position(v)));
        let [least, largest] = rooms.fold([f64::INFINITY, 0.0], |[least, largest], room| {
            [least.min(room), largest.max(room)]
        });
        let most = most * least + f64::from(f32::EPSILON) * largest;
        let [p, q, r] = corners.map(position);
        let normal = (q - p).cross(r - p).normalize();
        let is_in = |x: DVec3| (x - p).dot(normal).abs() <= most;
        vertices.iter().all(|&v| is_in(position(v)))
    }

    /// Whether one of two triangles lies in the plane of the other, as far as single precision
    /// tells. [`NO_TRIANGLE`] lies in none.
    pub fn coincide(&self, [a, b]: [u32; 2]) -> bool {
        /// Some 16 units in the last place.
        const ROUNDING: f64 = 1e-6;
        let lies_in = |flat: u32, other: u32| {
            let corners = self.triangles.get(flat as usize);
            corners.is_some_and(|corners| self.lie_in_plane(corners, other, ROUNDING))
        };
        ![a, b].contains(&NO_TRIANGLE) && (lies_in(a, b) || lies_in(b, a))
    }

    /// For each vertex of a mesh the first one at its position. It is also found while tiles are
    /// traced, when first asked for: this thread sorts alone, since one that waits for others to
    /// sort begins another tile, which would wait for what is only half found.
    pub fn welded(&self, mesh: usize) -> Vec<u32> {
        let (v0, v1) = (self.first_vertex[mesh], self.first_vertex[mesh + 1]);
        // Adding zero makes −0 and 0 one position.
        let bits = |v: u32| {
            (self.positions[v as usize] + 0.0)
                .to_array()
                .map(f32::to_bits)
        };
        let mut order: Vec<u32> = (v0..v1).collect();
        order.sort_unstable_by_key(|&v| (bits(v), v));
        let mut welded = vec![0; order.len()];
        for same in order.chunk_by(|&a, &b| bits(a) == bits(b)) {
            for &v in same {
                welded[(v - v0) as usize] = same[0];
            }
        }
        welded
    }

    /// The pictures on a triangle's mesh.
    pub fn pattern(&self, triangle: u32) -> Option<&Pattern> {
        self.patterns[self.mesh_of_triangle[triangle as usize] as usize].as_ref()
    }

    /// Whether a picture may jump within the triangle, if there is one.
    pub fn has_texture_edges(&self, triangle: u32) -> bool {
        triangle != NO_TRIANGLE
            && self
                .pattern(triangle)
                .is_some_and(|p| !p.rulings.is_empty())
    }

    /// Whether a picture turns the normals of a triangle.
    pub fn has_turned_normals(&self, triangle: u32) -> bool {
        self.pattern(triangle).is_some_and(|p| p.turns_normals)
    }

    /// The vertices of a triangle in each lane; lanes without one get a harmless unit triangle.
    pub fn corners(&self, triangle: &[u32; LANES]) -> [[u32; 3]; LANES] {
        triangle.map(|t| {
            if t == NO_TRIANGLE {
                [u32::MAX; 3]
            } else {
                self.triangles[t as usize]
            }
        })
    }

    /// One corner's positions in all lanes.
    pub fn gather_positions(&self, corners: &[[u32; 3]; LANES]) -> [V3<Lane>; 3] {
        const UNIT: [Vec3; 3] = [Vec3::ZERO, Vec3::X, Vec3::Y];
        gather(corners, |v, c| {
            if v == u32::MAX {
                UNIT[c]
            } else {
                self.positions[v as usize]
            }
        })
    }

    /// One corner's shading normals in all lanes; zero where the mesh is flat.
    pub fn gather_normals(&self, corners: &[[u32; 3]; LANES]) -> [V3<Lane>; 3] {
        gather(corners, |v, _| {
            if v == u32::MAX {
                Vec3::Z
            } else {
                self.normals[v as usize]
            }
        })
    }
}

/// Brings a vector of each vertex into lanes, for the three corners.
pub fn gather(corners: &[[u32; 3]; LANES], of: impl Fn(u32, usize) -> Vec3) -> [V3<Lane>; 3] {
    std::array::from_fn(|c| {
        let (mut x, mut y, mut z) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let v = of(corners[lane][c], c);
            (x[lane], y[lane], z[lane]) = (v.x, v.y, v.z);
        }
        V3 {
            x: Lane::new(x),
            y: Lane::new(y),
            z: Lane::new(z),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;
    use std::sync::atomic::{AtomicU32, Ordering};
    use std::time::Duration;

    thread_local! {
        static WELDS: Cell<bool> = const { Cell::new(false) };
    }

    /// A band of two triangles a square, each vertex of which stands there twice.
    fn band(squares: u32) -> Geometry {
        let corner = |v: u32| Vec3::new((v / 4) as f32, (v % 2) as f32, 0.0);
        let square = |i: u32| {
            [
                [4 * i, 4 * i + 1, 4 * i + 4],
                [4 * i + 3, 4 * i + 5, 4 * i + 6],
            ]
        };
        Geometry {
            positions: (0..4 * (squares + 1)).map(corner).collect(),
            origin: Vec3::ZERO,
            triangles: (0..squares).flat_map(square).collect(),
            mesh_of_triangle: vec![0; 2 * squares as usize],
            first_vertex: vec![0, 4 * (squares + 1)],
            first_triangle: vec![0, 2 * squares],
            normals: Vec::new(),
            uvs: Vec::new(),
            smooth: vec![false],
            patterns: vec![None],
            unit: 1.0,
        }
    }

    /// A small triangle in the plane of a large one, a little off it, and through it.
    #[test]
    fn what_lies_in_one_plane_coincides() {
        let coincide = |heights: [f32; 3]| {
            let mut geometry = band(2);
            let [x, y] = [Vec3::X, Vec3::Y].map(|v| v * 100.0);
            geometry.positions.extend([-x - y, x, y]);
            let corners = [[0.1, 0.1], [0.2, 0.1], [0.1, 0.3]].map(Vec2::from);
            let small = corners.iter().zip(heights).map(|(c, z)| c.extend(z));
            geometry.positions.extend(small);
            let first = geometry.positions.len() as u32 - 6;
            let triangles = [0, 3].map(|from| [0, 1, 2].map(|i| first + from + i));
            geometry.triangles.extend(triangles);
            let last = geometry.triangles.len() as u32 - 1;
            let both = geometry.coincide([last - 1, last]);
            assert_eq!(both, geometry.coincide([last, last - 1]));
            both
        };
        assert!(coincide([0.0; 3]) && coincide([5e-7, 0.0, -5e-7]));
        assert!(!coincide([1e-4; 3]) && !coincide([1e-4, 0.0, -1e-4]));
        assert!(!band(1).coincide([0, NO_TRIANGLE]));
    }

    /// Others have always something to do, and help whoever sorts with help.
    #[test]
    fn a_thread_that_welds_begins_nothing_else() {
        const JOBS: u32 = 10_000;
        const WELDED: u32 = 20;
        let geometry = band(100_000);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build();
        let begun = AtomicU32::new(0);
        pool.unwrap().scope(|scope| {
            for job in 0..JOBS {
                let (geometry, begun) = (&geometry, &begun);
                scope.spawn(move |_| {
                    begun.fetch_add(u32::from(WELDS.get()), Ordering::Relaxed);
                    if job % (JOBS / WELDED) == 0 {
                        WELDS.set(true);
                        let welded = geometry.welded(0);
                        assert!(welded.iter().enumerate().all(|(v, &w)| w == v as u32 & !2));
                        WELDS.set(false);
                    } else {
                        std::thread::sleep(Duration::from_micros(10));
                    }
                });
            }
        });
        assert_eq!(begun.into_inner(), 0);
    }
}
