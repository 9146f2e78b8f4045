//! What auxiliary rays meet.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::counts::Counts;
use crate::paths::rays::{RayPacket, lane_of};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::warp::follow::Follow;
use crate::trace::Coherence;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// What a packet of rays met.
pub struct PacketHits {
    triangle: [u32; LANES],
    b: [[f32; LANES]; 2],
}

/// Where one ray ended.
#[derive(Clone, Copy, Debug)]
pub struct Hit {
    pub triangle: u32,
    pub barycentrics: [f32; 2],
}

impl PacketHits {
    /// Follows auxiliary rays.
    pub fn trace(view: &SceneView, rays: &RayPacket, counts: &mut Counts) -> Self {
        counts.probe += u64::from(rays.active.count_ones());
        let triangle = view.intersect(rays, Coherence::Incoherent);
        Self::of(view, rays.origin, rays.direction, triangle)
    }

    /// Of rays that have been followed.
    pub fn of(
        view: &SceneView,
        origin: V3<Lane>,
        direction: V3<Lane>,
        triangle: [u32; LANES],
    ) -> Self {
        let vertices = Vertices {
            origin,
            direction,
            triangle,
            ..Vertices::default()
        };
        let b = view.barycentrics(&vertices).map(Lane::to_array);
        Self { triangle, b }
    }

    /// Where a lane's ray ended, if it met anything.
    pub fn lane(&self, lane: usize) -> Option<Hit> {
        (self.triangle[lane] != NO_TRIANGLE).then(|| Hit {
            triangle: self.triangle[lane],
            barycentrics: [self.b[0][lane], self.b[1][lane]],
        })
    }
}

impl Hit {
    /// To follow its point.
    pub fn followed(&self, lane: usize, share: f64, score: DVec3) -> Follow {
        Follow {
            lane: lane as u8,
            triangle: self.triangle,
            barycentrics: self.barycentrics,
            share: share as f32,
            score: score.as_vec3().to_array(),
        }
    }

    /// The point in the world.
    pub fn point(&self, geometry: &Geometry) -> DVec3 {
        self.followed(0, 1.0, DVec3::ZERO).point(geometry)
    }

    /// The triangle's normal, not of unit length.
    pub fn normal(&self, geometry: &Geometry) -> DVec3 {
        let corners = geometry.triangles[self.triangle as usize];
        let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
        (q - p).cross(r - p)
    }

    /// The mesh that it belongs to.
    pub fn mesh(&self, geometry: &Geometry) -> u32 {
        geometry.mesh_of_triangle[self.triangle as usize]
    }
}

/// A unit direction of one lane.
pub fn unit(v: V3<Lane>, lane: usize) -> DVec3 {
    lane_of(v, lane).as_dvec3().normalize()
}

/// The lanes of a bit mask.
pub fn lanes(bits: u32) -> impl Iterator<Item = usize> {
    (0..LANES).filter(move |&l| bits >> l & 1 == 1)
}
