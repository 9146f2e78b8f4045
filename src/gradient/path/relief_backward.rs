//! From normals that a picture turns to the picture and to what they were before, in the backward
//! sweep.

use crate::adjoint::relief::{bump_adjoint, relief_normal_adjoint};
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::scene::backward::TileSums;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::{lane_mask, lane_of, masked};
use crate::paths::surface::relief::{ReliefMaps, Turned, by_uv, local};
use crate::scene::Relief;
use glam::Vec3;

/// Cotangents of what a turned normal is made of.
pub(super) struct TurnedBars {
    /// Of the normal before.
    pub n: V3<Lane>,
    /// Of the ray that arrived.
    pub direction: V3<Lane>,
    pub corners: [V3<Lane>; 3],
    /// Of the barycentrics.
    pub b: [Lane; 2],
}

impl BackwardSweep<'_> {
    /// From the cotangent of the turned normal, which in lanes without a relief passes as it is.
    pub(super) fn relief(
        &self,
        here: &Solved,
        maps: &ReliefMaps,
        n_bar: V3<Lane>,
        sums: &mut TileSums,
    ) -> TurnedBars {
        let vertices = here.vertices;
        let (n, facing) = (here.base_n, vertices.facing);
        let relief = vertices.kinds.relief;
        let pictures = [maps.map, maps.rises];
        let slopes = maps.slopes;
        let [du, dv] = by_uv(here.corners, slopes);
        let is_bumpy = lane_mask(maps.bumps);
        let local = local((n, facing), [du, dv], pictures, is_bumpy, maps.signs);
        let bar = masked(relief, n_bar);
        let (base, du_bar, direction, local_bar) =
            relief_normal_adjoint(n, du, vertices.direction, local, bar);
        let map_bar = V3::new(
            local_bar.x * maps.signs[0],
            local_bar.y * maps.signs[1],
            local_bar.z,
        );
        let map_bar = masked(relief, map_bar);
        let (mut base, mut du_bar) = (masked(relief, base), masked(relief, du_bar));
        let mut dv_bar = V3::splat(0.0);
        let mut rises_bar = V3::splat(0.0);
        if maps.bumps != 0 {
            let bar = masked(maps.bumps, map_bar);
            let (up, along_u, along_v, rises) = bump_adjoint(n * facing, du, dv, maps.rises, bar);
            base = base + masked(maps.bumps, up * facing);
            du_bar = du_bar + masked(maps.bumps, along_u);
            dv_bar = masked(maps.bumps, along_v);
            rises_bar = masked(maps.bumps, rises);
        }
        let [[a, b], [c, d]] = slopes;
        let first = du_bar * a + dv_bar * c;
        let second = du_bar * b + dv_bar * d;
        TurnedBars {
            n: V3::select(lane_mask(relief), base, n_bar),
            direction: masked(relief, direction),
            corners: [-(first + second), first, second],
            b: self.relief_pictures(here, [map_bar, rises_bar], sums),
        }
    }

    /// From the cotangents of directions and rises to texels; returns those of the barycentrics.
    fn relief_pictures(
        &self,
        here: &Solved,
        [map_bar, rises_bar]: [V3<Lane>; 2],
        sums: &mut TileSums,
    ) -> [Lane; 2] {
        let mut b_bar = [[0.0; LANES]; 2];
        self.view
            .for_each_relief(here.vertices, here.b, |lane, relief, turned| {
                let bar = match turned {
                    Turned::Map(..) => lane_of(map_bar, lane),
                    Turned::Bumps(..) => lane_of(rises_bar, lane),
                };
                let slides = self.relief_picture(relief, &turned, bar, sums);
                for (sum, bar) in b_bar.iter_mut().zip(slides) {
                    sum[lane] += bar;
                }
            });
        b_bar.map(Lane::new)
    }

    /// The same of one relief, from the cotangent of its direction or of its rises.
    pub(crate) fn relief_picture(
        &self,
        relief: &Relief,
        turned: &Turned,
        bar: Vec3,
        sums: &mut TileSums,
    ) -> [f32; 2] {
        match turned {
            Turned::Map(found, _) => {
                sums.add_texture(self.wanted, relief.texture, found, bar * 2.0);
            }
            Turned::Bumps(rise, _) => {
                let bar = bar * relief.bumps.unwrap_or(1.0);
                for (i, weights) in rise.by_texels.iter().enumerate() {
                    for (&texel, weight) in rise.texels.iter().zip(weights) {
                        let value = Vec3::X * (bar[i] * weight);
                        sums.add_texel(self.wanted, relief.texture, texel, value);
                    }
                }
            }
        }
        turned.slopes(relief).map(|by| by.dot(bar))
    }
}
