//! Which lamps nothing can hide from a point.
//!
//! Most points of a scene see a lamp with nothing between. Boxes around meshes tell of many of
//! them, and on the lines of these over the lamp there is nothing to be found.

use crate::discontinuity::adjacency::Adjacency;
use crate::scene::RAY_OFFSET;
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Where there are more meshes, nothing is told.
const MOST_MESHES: usize = 64;
/// Of fewer triangles each is compared with all vertices. Of more they are with their neighbours,
/// and the mesh has to be closed.
const MANY_FACETS: u32 = 64;
/// Boxes are taken for larger, per unit of the largest coordinate and one.
const MARGIN: f64 = 1e-4;

/// What is known of all meshes; nothing if they are too many.
pub struct Clearance {
    meshes: Vec<Around>,
}

/// A box and a ball around a mesh.
struct Around {
    middle: DVec3,
    /// Half its extent.
    half: DVec3,
    /// Of the ball about the middle.
    radius: f64,
    /// Of the mesh's vertices.
    mean: DVec3,
    /// Whether the mesh is flat, or the whole or a part of the surface of something convex.
    is_convex: bool,
}

/// A point on a surface, from which a lamp is looked at.
pub struct Viewer {
    pub x: DVec3,
    /// The unit normal of its triangle, on either side.
    pub normal: DVec3,
    pub mesh: u32,
}

/// What is looked at of a lamp.
pub struct Lit {
    pub middle: DVec3,
    /// Half the extent of a box around it.
    pub half: DVec3,
    /// How far rays go, in distances of the middle.
    pub reach: f64,
    pub mesh: u32,
    /// Whether what the lamp hides of itself does not matter.
    pub is_one: bool,
}

impl Clearance {
    pub fn new(geometry: &Geometry, adjacency: &Adjacency) -> Self {
        let count = geometry.first_vertex.len() - 1;
        let known = if count > MOST_MESHES { 0 } else { count };
        Self {
            meshes: (0..known)
                .map(|mesh| Around::new(geometry, adjacency, mesh))
                .collect(),
        }
    }

    /// Whether nothing can lie between a point and any part of a lamp. That is never said of a lamp
    /// that reaches from above the plane of the point's triangle to below it.
    pub fn is_clear(&self, geometry: &Geometry, from: &Viewer, lit: &Lit) -> bool {
        let &Viewer { x, normal, mesh } = from;
        let way = lit.middle - x;
        let near = f64::from(RAY_OFFSET) * geometry.room(x);
        let height = normal.dot(way);
        if self.meshes.is_empty() || height.abs() < normal.abs().dot(lit.half) * lit.reach + near {
            return false;
        }
        let up = normal * height.signum();
        let may_hide = |(number, around): (usize, &Around)| {
            let number = number as u32;
            let is_below = match number == mesh && around.is_convex {
                true => up.dot(around.mean - x) <= near,
                false => around.highest(x, up) <= near,
            };
            let is_lamp = number == lit.mesh && (lit.is_one || around.is_convex);
            !is_below && !is_lamp && around.meets(x, way, lit)
        };
        !self.meshes.iter().enumerate().any(may_hide)
    }
}

impl Around {
    fn new(geometry: &Geometry, adjacency: &Adjacency, mesh: usize) -> Self {
        let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_vertex[m] as usize);
        let points = geometry.positions[first..end].iter().map(|p| p.as_dvec3());
        let low = points.clone().fold(DVec3::INFINITY, DVec3::min);
        let high = points.clone().fold(DVec3::NEG_INFINITY, DVec3::max);
        let middle = 0.5 * (low + high);
        let near = f64::from(RAY_OFFSET) * geometry.room(middle);
        let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m]);
        let is_convex = match end - first {
            0..=MANY_FACETS => (first..end).all(|t| {
                let mut points = points.clone();
                points.all(|x| height(geometry, t, x) <= near)
            }),
            _ => is_closed_convex(geometry, adjacency, mesh, near),
        };
        Self {
            middle,
            half: 0.5 * (high - low),
            radius: points
                .clone()
                .map(|p| p.distance(middle))
                .fold(0.0, f64::max),
            mean: points.clone().sum::<DVec3>() / points.len() as f64,
            is_convex,
        }
    }

    /// How far it rises above a plane through `x` at most.
    fn highest(&self, x: DVec3, up: DVec3) -> f64 {
        up.dot(self.middle - x) + up.abs().dot(self.half)
    }

    /// Whether it may meet what lies between a point and a lamp: boxes about x + t·way, t times as
    /// large as that around the lamp.
    fn meets(&self, x: DVec3, way: DVec3, lit: &Lit) -> bool {
        let largest = x.abs().max_element() + self.middle.abs().max_element() + 1.0;
        let half = self.half + MARGIN * largest;
        let offset = x - self.middle;
        // The same of balls: |offset + t·way| ≤ radius + t·lit.half.
        let (ball, grows) = (self.radius + MARGIN * largest, lit.half.length());
        let square = way.length_squared() - grows * grows;
        let linear = offset.dot(way) - ball * grows;
        let constant = offset.length_squared() - ball * ball;
        if square > 0.0 {
            let t = (-linear / square).clamp(0.0, lit.reach);
            if constant + t * (2.0 * linear + t * square) > 0.0 {
                return false;
            }
        }
        let [mut from, mut to] = [0.0, lit.reach];
        for axis in 0..3 {
            for sign in [1.0, -1.0] {
                // sign·(offset + t·way) ≤ half + t·lit.half
                let rest = half[axis] - sign * offset[axis];
                let slope = sign * way[axis] - lit.half[axis];
                if slope > 0.0 {
                    to = f64::min(to, rest / slope);
                } else if slope < 0.0 {
                    from = f64::max(from, rest / slope);
                } else if rest < 0.0 {
                    return false;
                }
            }
        }
        from <= to
    }
}

/// How far a point lies above a triangle's plane.
fn height(geometry: &Geometry, triangle: u32, x: DVec3) -> f64 {
    let corners = geometry.triangles[triangle as usize];
    let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
    (q - p).cross(r - p).normalize_or_zero().dot(x - p)
}

/// Whether a mesh is the surface of one convex body: closed, nowhere bent inward, and a sphere by
/// its numbers of vertices, edges and triangles.
fn is_closed_convex(geometry: &Geometry, adjacency: &Adjacency, mesh: usize, near: f64) -> bool {
    let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m]);
    let bends_outward = |(triangle, corner): (u32, usize)| {
        let Some(across) = adjacency.across(triangle, corner).filter(|a| !a.flipped) else {
            return false;
        };
        let other = geometry.triangles[across.triangle as usize];
        let apex = geometry.positions[other[(across.corner + 2) % 3] as usize];
        height(geometry, triangle, apex.as_dvec3()) <= near
    };
    let mut edges = (first..end).flat_map(|t| (0..3).map(move |corner| (t, corner)));
    if !edges.all(bends_outward) {
        return false;
    }
    let welded = geometry.welded(mesh);
    let v0 = geometry.first_vertex[mesh];
    let triangles = &geometry.triangles[first as usize..end as usize];
    let mut used: Vec<u32> = triangles
        .iter()
        .flatten()
        .map(|&v| welded[(v - v0) as usize])
        .collect();
    used.sort_unstable();
    used.dedup();
    2 * used.len() == triangles.len() + 4
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Quat, Vec3, vec3};

    /// Uniform numbers in [0, 1).
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f32 {
            self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1);
            (self.0 >> 40) as f32 / (1 << 24) as f32
        }

        fn place(&mut self, size: f32) -> Vec3 {
            vec3(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5) * size
        }
    }

    type Mesh = (Vec<Vec3>, Vec<[u32; 3]>);

    /// A square.
    fn plate() -> Mesh {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let positions = corners.map(|[x, y]| vec3(x, y, 0.0)).to_vec();
        (positions, vec![[0, 1, 2], [0, 2, 3]])
    }

    /// The part of a ball of quads around an axis that `rings` rings of it cover, of 12.
    fn ball(rings: u32) -> Mesh {
        let mut positions = Vec::new();
        for ring in 0..=rings {
            for sector in 0..8 {
                let (theta, phi) = (ring as f32 / 12.0, sector as f32 / 4.0);
                let [theta, phi] = [theta, phi].map(|x| x * std::f32::consts::PI);
                // At the poles zero, and all of a ring one point.
                let round = vec3(phi.cos(), phi.sin(), 0.0) * theta.sin().max(0.0);
                positions.push(round + Vec3::Z * theta.cos());
            }
        }
        let quad = |ring: u32, sector: u32| {
            let next = (sector + 1) % 8;
            let [a, b] = [sector, next].map(|s| 8 * ring + s);
            let [c, d] = [next, sector].map(|s| 8 * (ring + 1) + s);
            [[a, c, b], [a, d, c]]
        };
        let quads = (0..rings).flat_map(|r| (0..8).flat_map(move |s| quad(r, s)));
        // At the poles one of two has no area.
        let triangles = quads.filter(|&[p, q, r]| {
            let [p, q, r] = [p, q, r].map(|v: u32| positions[v as usize]);
            (q - p).cross(r - p).length() > 1e-5
        });
        let triangles = triangles.collect();
        (positions, triangles)
    }

    fn scene(meshes: Vec<Mesh>) -> Geometry {
        let mut all = Geometry {
            origin: Vec3::ZERO,
            positions: Vec::new(),
            triangles: Vec::new(),
            mesh_of_triangle: Vec::new(),
            first_vertex: vec![0],
            first_triangle: vec![0],
            normals: Vec::new(),
            uvs: Vec::new(),
            smooth: vec![false; meshes.len()],
            patterns: meshes.iter().map(|_| None).collect(),
            unit: 1.0,
        };
        for (number, (positions, triangles)) in meshes.into_iter().enumerate() {
            let base = all.positions.len() as u32;
            all.positions.extend(positions);
            all.triangles
                .extend(triangles.into_iter().map(|t| t.map(|v| v + base)));
            all.mesh_of_triangle
                .resize(all.triangles.len(), number as u32);
            all.first_vertex.push(all.positions.len() as u32);
            all.first_triangle.push(all.triangles.len() as u32);
        }
        all
    }

    /// Whether a triangle lies between two points.
    fn is_hidden(geometry: &Geometry, x: DVec3, y: DVec3) -> bool {
        (0..geometry.triangles.len()).any(|t| {
            let corners = geometry.triangles[t];
            let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
            let (d, normal) = (y - x, (q - p).cross(r - p));
            let t = normal.dot(p - x) / normal.dot(d);
            let at = x + d * t;
            let is_inside = [[p, q], [q, r], [r, p]]
                .iter()
                .all(|[a, b]| normal.dot((*b - *a).cross(at - *a)) > 0.0);
            t > 1e-4 && t < 1.0 - 1e-4 && is_inside
        })
    }

    /// Bodies of all kinds lie about at random. Nothing is ever between a point and a lamp that it
    /// is said to see all of, and of many that nothing hides this is said.
    #[test]
    fn what_is_clear_is_seen() {
        let mut numbers = Numbers(7);
        let [mut clear, mut seen] = [0; 2];
        for _ in 0..60 {
            let kinds = [plate(), plate(), ball(12), ball(6), ball(1)];
            let placed = |(positions, triangles): Mesh| {
                let turn = Quat::from_scaled_axis(numbers.place(6.0));
                let (size, middle) = (0.2 + numbers.next(), numbers.place(6.0));
                let positions = positions.into_iter().map(|p| turn * p * size + middle);
                (positions.collect(), triangles)
            };
            let meshes: Vec<Mesh> = kinds.into_iter().map(placed).collect();
            let geometry = scene(meshes);
            let adjacency = Adjacency::new(&geometry);
            let clearance = Clearance::new(&geometry, &adjacency);
            let lamp: [DVec3; 4] = std::array::from_fn(|v| geometry.positions[v].as_dvec3());
            let middle = 0.25 * lamp.iter().sum::<DVec3>();
            let half = lamp.map(|p| (p - middle).abs());
            let lit = Lit {
                middle,
                half: half.into_iter().fold(DVec3::ZERO, DVec3::max),
                reach: 1.0,
                mesh: 0,
                is_one: false,
            };
            for _ in 0..200 {
                let triangle = 2 + (numbers.next() * (geometry.triangles.len() - 2) as f32) as u32;
                let corners = geometry.triangles[triangle as usize];
                let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
                let [a, b] = [numbers.next(), numbers.next()].map(f64::from);
                let [a, b] = if a + b > 1.0 {
                    [1.0 - a, 1.0 - b]
                } else {
                    [a, b]
                };
                let viewer = Viewer {
                    x: p + (q - p) * a + (r - p) * b,
                    normal: (q - p).cross(r - p).normalize(),
                    mesh: geometry.mesh_of_triangle[triangle as usize],
                };
                let is_clear = clearance.is_clear(&geometry, &viewer, &lit);
                let hidden = (0..40).any(|_| {
                    let [s, t] = [numbers.next(), numbers.next()].map(f64::from);
                    let y = lamp[0] + (lamp[1] - lamp[0]) * s + (lamp[3] - lamp[0]) * t;
                    is_hidden(&geometry, viewer.x, y)
                });
                assert!(!(is_clear && hidden), "{:?}", viewer.x);
                clear += u32::from(is_clear);
                seen += u32::from(!hidden);
            }
        }
        assert!(3 * clear > seen, "{clear} of {seen}");
    }
}
