//! The scene as paths see it: its data, and the questions that rays answer.

use crate::lanes::{LANES, Lane};
use crate::paths::environment::distribution::MapDistribution;
use crate::paths::film::camera::Camera;
use crate::paths::light::patches::Lights;
use crate::paths::rays::{RayPacket, to_rays};
use crate::paths::surface::materials::MaterialTable;
use crate::scene::{DeltaLight, Scene};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use crate::trace::{Accel, Coherence, Hits, MISS, Rays};
use glam::Vec3;

/// What limits a path.
#[derive(Clone, Copy, Debug)]
pub struct PathLimits {
    pub max_depth: u32,
    pub rr_depth: u32,
    pub hide_emitters: bool,
    /// Paths go on from black surfaces: someone asks what would change if they reflected.
    pub black_goes_on: bool,
}

/// Everything a path needs to know of the scene.
pub struct SceneView<'a> {
    pub scene: &'a Scene,
    /// The scene's, about the geometry's origin.
    pub delta_lights: &'a [DeltaLight],
    pub geometry: &'a Geometry,
    pub accel: &'a Accel,
    pub lights: &'a Lights,
    pub materials: &'a MaterialTable,
    /// Given if there is an environment map.
    pub map_distribution: Option<&'a MapDistribution>,
    pub camera: Camera,
    pub limits: PathLimits,
}

impl SceneView<'_> {
    /// The triangle each ray meets first.
    pub fn intersect(&self, rays: &RayPacket, coherence: Coherence) -> [u32; LANES] {
        let mut hits = Hits::<LANES>::default();
        self.accel
            .intersect(&to_rays(rays), rays.active, &mut hits, coherence);
        std::array::from_fn(|l| {
            if rays.active >> l & 1 == 1 && hits.mesh[l] != MISS {
                self.geometry.first_triangle[hits.mesh[l] as usize] + hits.triangle[l]
            } else {
                NO_TRIANGLE
            }
        })
    }

    /// The triangle one ray meets first.
    pub fn first_hit(&self, origin: Vec3, direction: Vec3, near: f32, far: f32) -> u32 {
        let mut ray = Rays::<1>::default();
        ray.set(0, origin, direction, near, far);
        let mut hit = Hits::<1>::default();
        self.accel
            .intersect(&ray, 1, &mut hit, Coherence::Incoherent);
        match hit.mesh[0] {
            MISS => NO_TRIANGLE,
            mesh => self.geometry.first_triangle[mesh as usize] + hit.triangle[0],
        }
    }

    /// The active lanes whose rays meet nothing; the rays are added to `count`.
    pub fn unoccluded(&self, rays: &RayPacket, count: &mut u64) -> u32 {
        self.unoccluded_before(Lane::splat(rays.far), rays, count)
    }

    /// Those whose rays meet nothing before `far`.
    pub fn unoccluded_before(&self, far: Lane, rays: &RayPacket, count: &mut u64) -> u32 {
        if rays.active == 0 {
            return 0;
        }
        *count += rays.active.count_ones() as u64;
        let ahead = Rays {
            tfar: far.to_array(),
            ..to_rays(rays)
        };
        let occluded = self
            .accel
            .occluded(&ahead, rays.active, Coherence::Incoherent);
        rays.active & !occluded
    }
}
