//! What a pilot sees of the film around a node of its drift.

use crate::kernels::triangle::triangle_hit;
use crate::lanes::{LANES, V3};
use crate::paths::dimensions::Single;
use crate::paths::film::drift::{DriftGrid, Followed};
use crate::paths::random::Stream;
use crate::paths::scene_view::SceneView;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use glam::DVec3;
use std::array::from_fn;

/// The pilot has a group to itself.
const GROUP: u32 = u32::MAX;

/// The pilot's random numbers.
pub fn stream(seed: u64) -> Stream {
    Stream::new(seed, [GROUP, 0])
}

/// A few points around a node.
pub struct NodeHits {
    /// Of the film.
    points: [[f64; 2]; LANES],
    /// Of the rays through them.
    pub directions: [DVec3; LANES],
    /// What they see, where they see anything.
    pub hits: Vec<Hit>,
}

/// What one of a node's rays hits.
pub struct Hit {
    pub lane: usize,
    pub triangle: u32,
    pub mesh: u32,
    /// From the eye, in lengths of the ray's direction.
    pub distance: f64,
    /// Of the triangle's second and third corner.
    pub barycentrics: [f64; 2],
    pub moves: bool,
}

impl NodeHits {
    /// Looks around a node, at meshes of which some move.
    pub fn around(
        view: &SceneView,
        stream: &Stream,
        (grid, node): (&DriftGrid, usize),
        moves: impl Fn(usize) -> bool,
    ) -> Self {
        let camera = &view.camera;
        let geometry = view.geometry;
        let middle = grid.position(node);
        let points: [[f64; 2]; LANES] = from_fn(|point| {
            [0, 1].map(|i| {
                let name = [node as u32, point as u32, i as u32];
                let random = f64::from(stream.single(Single::DriftPoint, name));
                middle[i] + (2.0 * random - 1.0) * grid.spacing[i]
            })
        });
        let directions = points.map(|[u, v]| {
            let V3 { x, y, z } = camera.direction(u, v);
            DVec3::new(x, y, z)
        });
        let rays = camera.rays_along(&directions, u32::MAX >> (32 - LANES));
        let seen = view.intersect(&rays, Coherence::Coherent);
        let vector = |p: DVec3| V3::new(p.x, p.y, p.z);
        let origin = vector(camera.eye());
        let hit = |lane: usize| {
            let triangle = seen[lane];
            let corners = geometry.triangles[triangle as usize];
            let [v0, v1, v2] = corners.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
            let (distance, b1, b2) = triangle_hit(origin, vector(directions[lane]), v0, v1, v2);
            let mesh = geometry.mesh_of_triangle[triangle as usize];
            Hit {
                lane,
                triangle,
                mesh,
                distance,
                barycentrics: [b1, b2],
                moves: moves(mesh as usize),
            }
        };
        let met = (0..LANES).filter(|&l| seen[l] != NO_TRIANGLE).map(hit);
        let hits = met.filter(|h| h.distance.is_finite()).collect();
        Self {
            points,
            directions,
            hits,
        }
    }

    /// One of them, followed.
    pub fn follow(&self, view: &SceneView, hit: &Hit, share: f64) -> Followed {
        let [b1, b2] = hit.barycentrics;
        Followed {
            triangle: view.geometry.triangles[hit.triangle as usize],
            barycentrics: [1.0 - b1 - b2, b1, b2],
            at: self.points[hit.lane],
            share,
        }
    }
}
