//! Eight rays that go much the same way through a compressed tree at once.
//!
//! obvhs traces one ray at a time; this goes over its nodes in its order, with other tests. Answers
//! are those of [`super::single`], number for number.

use super::boxes::Bundle;
use super::lanes::lanes_of;
use super::ray::{Ray, is_sound, longest};
use super::single::{NOWHERE, Nearest, Walk};
use super::triangle::{EightRays, Meeting, Triangle};
use crate::lanes::F32x8;
use crate::trace::Rays;
use glam::UVec2;
use obvhs::cwbvh::CwBvh;

/// Eight lanes of a packet, those that are asked and sound.
pub struct Eight<'a, const N: usize> {
    rays: &'a Rays<N>,
    /// The first of the lanes in the packet.
    at: usize,
    lanes: u32,
    bundle: Bundle,
    eight: EightRays,
    tnear: F32x8,
    tfar: F32x8,
    direction: [f32; 3],
}

impl<'a, const N: usize> Eight<'a, N> {
    /// `None` if fewer than two of the lanes, a bit each, are asked, or they do not go the same
    /// way.
    pub fn new(rays: &'a Rays<N>, at: usize, asked: u32) -> Option<Self> {
        let sound = |lane: &usize| asked >> lane & 1 == 1 && is_sound(rays, at + lane);
        let lanes = (0..8).filter(sound).fold(0, |all, lane| all | 1 << lane);
        if u32::count_ones(lanes) < 2 {
            return None;
        }
        // Lanes that are not asked do as the first one does, and reach nowhere.
        let first = lanes.trailing_zeros() as usize;
        let from = |lane: usize| at + if lanes >> lane & 1 == 1 { lane } else { first };
        let take = |v: &[f32; N]| -> [f32; 8] { std::array::from_fn(|lane| v[from(lane)]) };
        let origin = [&rays.org_x, &rays.org_y, &rays.org_z].map(take);
        let direction = [&rays.dir_x, &rays.dir_y, &rays.dir_z].map(take);
        let of_lane = |lane: usize| direction.map(|d| d[lane]);
        let axis = longest(of_lane(first));
        if (0..8).any(|lane| longest(of_lane(lane)) != axis) {
            return None;
        }
        let tnear = take(&rays.tnear);
        let tfar = std::array::from_fn(|lane| {
            if lanes >> lane & 1 == 1 {
                rays.tfar[at + lane]
            } else {
                f32::NEG_INFINITY
            }
        });
        Some(Self {
            rays,
            at,
            lanes,
            bundle: Bundle::new(origin, direction, tnear)?,
            eight: EightRays::new(origin, direction, axis),
            tnear: F32x8::new(tnear),
            tfar: F32x8::new(tfar),
            direction: of_lane(first),
        })
    }

    /// The first triangle that each ray meets; lanes that are not asked meet nothing.
    pub fn first(&self, bvh: &CwBvh, triangles: &[Triangle]) -> [Nearest; 8] {
        let mut nearest = EightNearest::nothing(self.tfar);
        let mut farthest = greatest(nearest.t);
        let mut state = Walk::along(self.direction);
        let mut node;
        obvhs::traverse!(
            bvh,
            node,
            state,
            self.bundle
                .wide_hits(node, nearest.t, farthest, state.oct_inv4),
            {
                let place = state.primitive_id;
                let triangle = &triangles[place as usize];
                let met = self.eight.meet(triangle);
                if met.lanes & self.lanes != 0 {
                    let beyond = met.t.simd_gt(self.tnear) & met.inside;
                    let nearer = beyond & met.t.simd_lt(nearest.t);
                    let equal = (beyond & met.t.simd_eq(nearest.t)).to_bitmask() & self.lanes;
                    nearest.take(nearer, met.t, met.uv, place);
                    for lane in lanes_of(equal) {
                        nearest.offer(lane, met.in_lane(lane), place, triangles);
                    }
                    farthest = greatest(nearest.t);
                }
                for lane in lanes_of(met.unsure & self.lanes) {
                    if let Some((ray, _)) = Ray::of(self.rays, self.at + lane)
                        && let Some(meeting) = triangle.meet(&ray)
                        && meeting.t > ray.tnear
                    {
                        nearest.offer(lane, meeting, place, triangles);
                        farthest = greatest(nearest.t);
                    }
                }
            }
        );
        nearest.to_array()
    }

    /// Which rays meet anything, a bit each.
    pub fn any(&self, bvh: &CwBvh, triangles: &[Triangle]) -> u32 {
        let mut tfar = self.tfar;
        let mut farthest = greatest(tfar);
        let mut blocked = 0;
        let mut state = Walk::along(self.direction);
        let mut node;
        obvhs::traverse!(
            bvh,
            node,
            state,
            self.bundle.wide_hits(node, tfar, farthest, state.oct_inv4),
            {
                let triangle = &triangles[state.primitive_id as usize];
                let met = self.eight.meet(triangle);
                let between = met.t.simd_gt(self.tnear) & met.t.simd_le(tfar);
                let mut now = met.lanes & between.to_bitmask();
                for lane in lanes_of(met.unsure & self.lanes) {
                    if let Some((ray, far)) = Ray::of(self.rays, self.at + lane) {
                        let meeting = triangle.meet(&ray);
                        let hits = meeting.is_some_and(|m| m.t > ray.tnear && m.t <= far);
                        now |= u32::from(hits) << lane;
                    }
                }
                if now & !blocked != 0 {
                    blocked |= now;
                    if blocked & self.lanes == self.lanes {
                        return self.lanes;
                    }
                    let mut left = tfar.to_array();
                    for lane in lanes_of(blocked) {
                        left[lane] = f32::NEG_INFINITY;
                    }
                    tfar = F32x8::new(left);
                    farthest = greatest(tfar);
                }
            }
        );
        blocked & self.lanes
    }
}

/// The nearest triangle of each lane so far.
struct EightNearest {
    t: F32x8,
    uv: [F32x8; 2],
    /// As the bits of floats, which are only ever moved.
    places: F32x8,
}

impl EightNearest {
    /// Nothing, up to `tfar`.
    fn nothing(tfar: F32x8) -> Self {
        Self {
            t: tfar,
            uv: [F32x8::splat(0.0); 2],
            places: F32x8::splat(f32::from_bits(NOWHERE)),
        }
    }

    /// Takes a triangle in the lanes of a mask.
    #[inline(always)]
    fn take(&mut self, nearer: F32x8, t: F32x8, uv: [F32x8; 2], place: u32) {
        self.t = nearer.select(t, self.t);
        self.uv = [
            nearer.select(uv[0], self.uv[0]),
            nearer.select(uv[1], self.uv[1]),
        ];
        let place = F32x8::splat(f32::from_bits(place));
        self.places = nearer.select(place, self.places);
    }

    /// Offers one lane a triangle, as [`Nearest::offer`] does a single ray.
    #[cold]
    fn offer(&mut self, lane: usize, meeting: Meeting, place: u32, triangles: &[Triangle]) {
        let mut nearest = self.in_lane(lane);
        nearest.offer(meeting, place, triangles);
        let put = |to: &mut F32x8, value: f32| {
            let mut lanes = to.to_array();
            lanes[lane] = value;
            *to = F32x8::new(lanes);
        };
        put(&mut self.t, nearest.meeting.t);
        put(&mut self.uv[0], nearest.meeting.uv[0]);
        put(&mut self.uv[1], nearest.meeting.uv[1]);
        put(&mut self.places, f32::from_bits(nearest.place));
    }

    fn in_lane(&self, lane: usize) -> Nearest {
        self.to_array()[lane]
    }

    fn to_array(&self) -> [Nearest; 8] {
        let (t, places) = (self.t.to_array(), self.places.to_array());
        let [u, v] = self.uv.map(F32x8::to_array);
        std::array::from_fn(|lane| Nearest {
            meeting: Meeting {
                t: t[lane],
                uv: [u[lane], v[lane]],
            },
            place: places[lane].to_bits(),
        })
    }
}

fn greatest(v: F32x8) -> f32 {
    v.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max)
}
