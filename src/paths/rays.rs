//! Packets of rays, and one lane of a vector.

use crate::lanes::{LANES, Lane, Real, V3};
use crate::scene::Rgb;
use crate::trace::Rays;
use glam::Vec3;

/// Rays that are about to be traced.
#[derive(Clone, Copy)]
pub struct RayPacket {
    pub active: u32,
    pub origin: V3<Lane>,
    pub direction: V3<Lane>,
    pub near: f32,
    pub far: f32,
}

/// As Embree takes them.
pub fn to_rays(rays: &RayPacket) -> Rays<LANES> {
    Rays {
        org_x: rays.origin.x.to_array(),
        org_y: rays.origin.y.to_array(),
        org_z: rays.origin.z.to_array(),
        tnear: [rays.near; LANES],
        dir_x: rays.direction.x.to_array(),
        dir_y: rays.direction.y.to_array(),
        dir_z: rays.direction.z.to_array(),
        tfar: [rays.far; LANES],
    }
}

/// One lane of a vector.
pub fn lane_of(v: V3<Lane>, lane: usize) -> Vec3 {
    Vec3::new(
        v.x.to_array()[lane],
        v.y.to_array()[lane],
        v.z.to_array()[lane],
    )
}

/// A vector a lane.
pub fn from_lanes(v: &[Vec3; LANES]) -> V3<Lane> {
    V3 {
        x: Lane::new(v.map(|p| p.x)),
        y: Lane::new(v.map(|p| p.y)),
        z: Lane::new(v.map(|p| p.z)),
    }
}

/// A constant vector in every lane.
pub fn splat<F: Real>(v: Vec3) -> V3<F> {
    V3::new(
        F::splat(v.x as f64),
        F::splat(v.y as f64),
        F::splat(v.z as f64),
    )
}

/// One colour a lane.
pub fn to_rgb(v: V3<Lane>) -> [Rgb; LANES] {
    let (x, y, z) = (v.x.to_array(), v.y.to_array(), v.z.to_array());
    std::array::from_fn(|l| [x[l], y[l], z[l]])
}

/// The lanes of a bit mask, as the lane type's own mask.
pub fn lane_mask(bits: u32) -> <Lane as Real>::Mask {
    let ones = std::array::from_fn(|l| if bits >> l & 1 == 1 { 1.0 } else { 0.0 });
    Lane::new(ones).gt(Lane::splat(0.5))
}

/// The lanes of a vector that `bits` selects, zero elsewhere.
pub fn masked(bits: u32, v: V3<Lane>) -> V3<Lane> {
    V3::select(lane_mask(bits), v, V3::splat(0.0))
}
