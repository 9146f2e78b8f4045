//! A watertight test of triangles, after Woop, Benthin and Wald 2013 (Woop2013 in
//! `docs/references.bib`).
//!
//! The corners are moved and sheared so that the ray becomes an axis; what is left is whether the
//! origin of a plane lies in a triangle. A corner's place in that plane is rounded, but for all
//! triangles that share it alike, and the signs of the edge functions are exact: a rounded
//! difference of two products has the right sign unless it is zero, and then it is taken again in
//! f64, which holds products of f32 exactly. So what lies outside of a triangle lies on the right
//! side of its neighbour, at edges and at corners: nothing gets through.

use super::ray::{Ray, axes_from};
use crate::lanes::F32x8;

/// A triangle where the tree keeps it, beside those of the same leaf.
#[derive(Clone, Copy, Debug)]
pub struct Triangle {
    pub corners: [[f32; 3]; 3],
    pub mesh: u32,
    /// Its number in its mesh.
    pub triangle: u32,
}

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    pub t: f32,
    /// Weights of the second and third corner.
    pub uv: [f32; 2],
}

impl Triangle {
    /// Where `ray` meets it, at whatever distance.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray) -> Option<Meeting> {
        // Known places are faster to read than counted ones.
        match ray.axis {
            0 => self.meet_along::<0, 1, 2>(ray),
            1 => self.meet_along::<1, 2, 0>(ray),
            _ => self.meet_along::<2, 0, 1>(ray),
        }
    }

    #[inline(always)]
    fn meet_along<const Z: usize, const X: usize, const Y: usize>(
        &self,
        ray: &Ray,
    ) -> Option<Meeting> {
        let [a, b, c] = self.corners.map(|corner| {
            let along = corner[Z] - ray.origin[Z];
            [
                (corner[X] - ray.origin[X]) - ray.shear[0] * along,
                (corner[Y] - ray.origin[Y]) - ray.shear[1] * along,
                ray.shear[2] * along,
            ]
        });
        let edge = |p: [f32; 3], q: [f32; 3]| p[0] * q[1] - p[1] * q[0];
        let mut weights = [edge(c, b), edge(a, c), edge(b, a)];
        if weights.contains(&0.0) {
            let exact = |p: [f32; 3], q: [f32; 3]| {
                let [p, q] = [p.map(f64::from), q.map(f64::from)];
                p[0] * q[1] - p[1] * q[0]
            };
            let signs = [exact(c, b), exact(a, c), exact(b, a)];
            if signs.iter().any(|s| *s < 0.0) && signs.iter().any(|s| *s > 0.0) {
                return None;
            }
            weights = signs.map(|s| s as f32);
        } else if weights.iter().any(|w| *w < 0.0) && weights.iter().any(|w| *w > 0.0) {
            return None;
        }
        let [u, v, w] = weights;
        let area = u + v + w;
        if area == 0.0 {
            return None;
        }
        let t = (u * a[2] + v * b[2] + w * c[2]) / area;
        Some(Meeting {
            t,
            uv: [v / area, w / area],
        })
    }
}

/// Eight rays that are longest along the same axis.
pub struct EightRays {
    origin: [F32x8; 3],
    shear: [F32x8; 3],
    axis: usize,
}

/// Where eight rays meet a triangle.
pub struct EightMeetings {
    /// Lanes that meet it.
    pub lanes: u32,
    /// The same with all bits of a lane set.
    pub inside: F32x8,
    /// Lanes that pass so near an edge that [`Triangle::meet`] has to say.
    pub unsure: u32,
    pub t: F32x8,
    pub uv: [F32x8; 2],
}

impl EightMeetings {
    /// One lane.
    pub fn in_lane(&self, lane: usize) -> Meeting {
        Meeting {
            t: self.t.to_array()[lane],
            uv: self.uv.map(|x| x.to_array()[lane]),
        }
    }
}

impl EightRays {
    /// By component, rays that are all longest along `axis`.
    pub fn new(origin: [[f32; 8]; 3], direction: [[f32; 8]; 3], axis: usize) -> Self {
        let [z, x, y] = axes_from(axis);
        let direction = direction.map(F32x8::new);
        Self {
            origin: origin.map(F32x8::new),
            shear: [
                direction[x] / direction[z],
                direction[y] / direction[z],
                F32x8::splat(1.0) / direction[z],
            ],
            axis,
        }
    }

    /// [`Triangle::meet`] in eight lanes, number for number.
    #[inline(always)]
    pub fn meet(&self, triangle: &Triangle) -> EightMeetings {
        let [z, x, y] = axes_from(self.axis);
        let [a, b, c] = triangle.corners.map(|corner| {
            let along = F32x8::splat(corner[z]) - self.origin[z];
            [
                (F32x8::splat(corner[x]) - self.origin[x]) - self.shear[0] * along,
                (F32x8::splat(corner[y]) - self.origin[y]) - self.shear[1] * along,
                self.shear[2] * along,
            ]
        });
        let edge = |p: [F32x8; 3], q: [F32x8; 3]| p[0] * q[1] - p[1] * q[0];
        let (u, v, w) = (edge(c, b), edge(a, c), edge(b, a));
        let zero = F32x8::splat(0.0);
        let least = u.fast_min(v).fast_min(w);
        let most = u.fast_max(v).fast_max(w);
        let inside = least.simd_gt(zero) | most.simd_lt(zero);
        let at_edge = u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero);
        let (lanes, unsure) = (inside.to_bitmask(), at_edge.to_bitmask());
        let area = u + v + w;
        let mut meetings = EightMeetings {
            lanes,
            inside,
            unsure,
            t: zero,
            uv: [zero; 2],
        };
        if lanes != 0 {
            meetings.t = (u * a[2] + v * b[2] + w * c[2]) / area;
            meetings.uv = [v / area, w / area];
        }
        meetings
    }
}
