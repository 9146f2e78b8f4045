//! Conservative tests of rays against boxes: what a triangle's test accepts is never culled.
//!
//! With ε = 2⁻²⁴ the distance to a plane, (plane − origin) / direction, is off by some three ε of
//! its value, and the corner of a triangle, as [`super::triangle`] places it beside the ray, by
//! some five ε of its distance from the origin. So boxes grow on all sides by [`PAD`] times their
//! distance, more than both. The planes of a compressed node are p + q·e: growing by a thousandth
//! of e covers also what was rounded when they were compressed.

use super::ray::{Ray, inverse};
use crate::lanes::F32x8;
use obvhs::aabb::Aabb;
use obvhs::cwbvh::node::{CwBvhNode, extract_byte64};

/// 16 ε.
const PAD: f32 = 1.0 / (1u32 << 20) as f32;
/// The same for what lies 255 steps away, and a thousandth of a step.
const STEP_PAD: f32 = 255.0 * PAD + 1.0 / 1024.0;

/// Which children of a compressed node a ray meets before `tfar`, as obvhs's traversal takes them:
/// a bit for each triangle of a leaf and for each node.
#[inline(always)]
pub fn wide_hits(node: &CwBvhNode, ray: &Ray, tfar: f32, octant: u32) -> u32 {
    let step = node.compute_extent().to_array();
    let corner = node.p.to_array();
    let planes = planes(node);
    let mut near = F32x8::splat(ray.tnear);
    let mut far = F32x8::splat(tfar);
    for axis in 0..3 {
        let distance = corner[axis] - ray.origin[axis];
        let inverse = ray.inverse[axis];
        let pad = (distance.abs() * PAD + step[axis] * STEP_PAD) * inverse.abs();
        let scale = F32x8::splat(step[axis] * inverse);
        let (low, high) = in_order(planes[axis], inverse);
        near = near.fast_max(eight(low) * scale + F32x8::splat(distance * inverse - pad));
        far = far.fast_min(eight(high) * scale + F32x8::splat(distance * inverse + pad));
    }
    children(node, near.simd_le(far).to_bitmask(), octant)
}

/// Where a ray enters a box that it meets before `tfar`.
#[inline(always)]
pub fn entry(bounds: &Aabb, ray: &Ray, tfar: f32) -> Option<f32> {
    let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
    let (mut near, mut far) = (ray.tnear, tfar);
    for axis in 0..3 {
        let inverse = ray.inverse[axis];
        let (low, high) = in_order((low[axis], high[axis]), inverse);
        let first = (low - ray.origin[axis]) * inverse;
        let last = (high - ray.origin[axis]) * inverse;
        let pad = PAD * first.abs().max(last.abs());
        near = near.max(first - pad);
        far = far.min(last + pad);
    }
    (near <= far).then_some(near)
}

/// Eight rays of one octant: what bounds them all, and each of them.
pub struct Bundle {
    origin: [F32x8; 3],
    inverse: [F32x8; 3],
    /// By axis: the origins nearest to and farthest from what lies ahead.
    origins: [(f32, f32); 3],
    /// By axis: the smallest and the largest inverse direction.
    inverses: [(f32, f32); 3],
    tnear: F32x8,
    least_tnear: f32,
}

impl Bundle {
    /// `None` if the directions differ in sign. All lanes must be sound.
    pub fn new(origin: [[f32; 8]; 3], direction: [[f32; 8]; 3], tnear: [f32; 8]) -> Option<Self> {
        let inverses = direction.map(|d| d.map(inverse));
        let signs = inverses.map(|v| F32x8::new(v).simd_lt(F32x8::splat(0.0)).to_bitmask());
        if signs.iter().any(|s| *s != 0 && *s != 0xff) {
            return None;
        }
        let range = |v: [f32; 8]| {
            let least = v.iter().copied().fold(f32::INFINITY, f32::min);
            (least, v.iter().copied().fold(f32::NEG_INFINITY, f32::max))
        };
        Some(Self {
            origin: origin.map(F32x8::new),
            inverse: inverses.map(F32x8::new),
            origins: std::array::from_fn(|axis| {
                let (least, most) = range(origin[axis]);
                if signs[axis] == 0 {
                    (most, least)
                } else {
                    (least, most)
                }
            }),
            inverses: inverses.map(range),
            tnear: F32x8::new(tnear),
            least_tnear: range(tnear).0,
        })
    }

    /// [`wide_hits`] for any of the rays; `farthest` is the largest of `tfar`.
    ///
    /// First all children against what bounds the rays, then the rays against what is left.
    #[inline(always)]
    pub fn wide_hits(&self, node: &CwBvhNode, tfar: F32x8, farthest: f32, octant: u32) -> u32 {
        let step = node.compute_extent().to_array();
        let corner = node.p.to_array();
        let planes = planes(node);
        let mut near = F32x8::splat(self.least_tnear);
        let mut far = F32x8::splat(farthest);
        for axis in 0..3 {
            let (least, most) = self.inverses[axis];
            let (low, high) = in_order(planes[axis], least);
            let away = |origin: f32, side: f32| {
                let distance = corner[axis] - origin;
                let pad = distance.abs() * PAD + step[axis] * STEP_PAD;
                F32x8::splat(distance + side * pad.copysign(least))
            };
            let (nearest, farthest) = self.origins[axis];
            let first = eight(low) * F32x8::splat(step[axis]) + away(nearest, -1.0);
            let last = eight(high) * F32x8::splat(step[axis]) + away(farthest, 1.0);
            let (least, most) = (F32x8::splat(least), F32x8::splat(most));
            near = near.fast_max((first * least).fast_min(first * most));
            far = far.fast_min((last * least).fast_max(last * most));
        }
        let mut found = near.simd_le(far).to_bitmask();
        if found == 0 {
            return 0;
        }
        let mut offset = [F32x8::splat(0.0); 3];
        let mut pad = offset;
        let mut scale = offset;
        for axis in 0..3 {
            let distance = F32x8::splat(corner[axis]) - self.origin[axis];
            offset[axis] = distance * self.inverse[axis];
            let width = distance.abs() * F32x8::splat(PAD) + F32x8::splat(step[axis] * STEP_PAD);
            pad[axis] = width * self.inverse[axis].abs();
            scale[axis] = F32x8::splat(step[axis]) * self.inverse[axis];
        }
        let mut left = found;
        while left != 0 {
            let child = left.trailing_zeros() as usize;
            left &= left - 1;
            let (mut near, mut far) = (self.tnear, tfar);
            for axis in 0..3 {
                let (low, high) = in_order(planes[axis], self.inverses[axis].0);
                let plane = |q: &[u8; 8]| F32x8::splat(f32::from(q[child])) * scale[axis];
                near = near.fast_max(plane(low) + (offset[axis] - pad[axis]));
                far = far.fast_min(plane(high) + (offset[axis] + pad[axis]));
            }
            if near.simd_le(far).none() {
                found &= !(1 << child);
            }
        }
        children(node, found, octant)
    }
}

/// The sides of the children, by axis.
#[inline(always)]
fn planes(node: &CwBvhNode) -> [(&[u8; 8], &[u8; 8]); 3] {
    [
        (&node.child_min_x, &node.child_max_x),
        (&node.child_min_y, &node.child_max_y),
        (&node.child_min_z, &node.child_max_z),
    ]
}

/// The side that a ray meets first, then the other.
#[inline(always)]
fn in_order<T>((low, high): (T, T), inverse: f32) -> (T, T) {
    if inverse < 0.0 {
        (high, low)
    } else {
        (low, high)
    }
}

#[inline(always)]
fn eight(q: &[u8; 8]) -> F32x8 {
    F32x8::new(q.map(f32::from))
}

/// The bits of some of the children.
#[inline(always)]
fn children(node: &CwBvhNode, mut found: u32, octant: u32) -> u32 {
    let (bits, places) = node.get_child_and_index_bits(octant);
    let mut hits = 0;
    while found != 0 {
        let child = found.trailing_zeros() as usize;
        found &= found - 1;
        hits |= extract_byte64(bits, child) << extract_byte64(places, child);
    }
    hits
}
