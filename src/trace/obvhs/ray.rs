//! One ray, readied for boxes and triangles.

use crate::trace::Rays;
use crate::trace::packet::LARGEST;

/// Direction components smaller than this divide as if they were this large, so that no plane is at
/// infinity times zero.
const LEAST_COMPONENT: f32 = 1e-18;

/// A ray with what every box and every triangle asks of it.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    pub origin: [f32; 3],
    pub direction: [f32; 3],
    /// 1 / direction, finite.
    pub inverse: [f32; 3],
    /// Hits nearer than this, or at it, do not count.
    pub tnear: f32,
    /// The axis along which the ray is longest.
    pub axis: usize,
    /// Steps along the two axes after it, and of the distance, for each step along it.
    pub shear: [f32; 3],
}

impl Ray {
    /// Lane `i` of a packet and how far it reaches; `None` if it can meet nothing.
    #[inline(always)]
    pub fn of<const N: usize>(rays: &Rays<N>, i: usize) -> Option<(Self, f32)> {
        let origin = [rays.org_x[i], rays.org_y[i], rays.org_z[i]];
        let direction = [rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]];
        is_sound(rays, i).then(|| (Self::new(origin, direction, rays.tnear[i]), rays.tfar[i]))
    }

    fn new(origin: [f32; 3], direction: [f32; 3], tnear: f32) -> Self {
        let axis = longest(direction);
        let [z, x, y] = axes_from(axis);
        let along = direction[z];
        Self {
            origin,
            direction,
            inverse: direction.map(inverse),
            tnear,
            axis,
            shear: [direction[x] / along, direction[y] / along, 1.0 / along],
        }
    }
}

/// Whether a lane can meet anything: it is within reach, not empty, and has a direction.
#[inline(always)]
pub fn is_sound<const N: usize>(rays: &Rays<N>, i: usize) -> bool {
    let direction = [rays.dir_x[i], rays.dir_y[i], rays.dir_z[i]];
    let rest = [rays.org_x[i], rays.org_y[i], rays.org_z[i], rays.tnear[i]];
    let reaches = rest.iter().chain(&direction).all(|x| x.abs() <= LARGEST);
    reaches && rays.tfar[i] >= rays.tnear[i] && direction != [0.0; 3]
}

/// The axis of the largest component.
pub fn longest(direction: [f32; 3]) -> usize {
    let [x, y, z] = direction.map(f32::abs);
    if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    }
}

/// An axis and the two after it.
pub fn axes_from(first: usize) -> [usize; 3] {
    [first, (first + 1) % 3, (first + 2) % 3]
}

/// 1 / x, finite.
pub fn inverse(x: f32) -> f32 {
    1.0 / if x.abs() < LEAST_COMPONENT {
        LEAST_COMPONENT.copysign(x)
    } else {
        x
    }
}
