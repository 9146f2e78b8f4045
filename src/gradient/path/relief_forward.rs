//! The forward sweep over surfaces whose normals pictures turn.

use crate::gradient::path::forward::{Arriving, D, ForwardSweep, MovingVertex, constant};
use crate::gradient::scene::forward::dual_vector;
use crate::kernels::relief::{relief_normal, relief_shadow};
use crate::lanes::V3;
use crate::paths::rays::lane_mask;
use crate::paths::store::Vertices;
use crate::paths::surface::relief::{Turned, by_uv, local};
use crate::scene::Relief;

impl ForwardSweep<'_> {
    /// The normal that a picture turns, where there is one.
    pub(super) fn turned(
        &self,
        vertices: &Vertices,
        chain: &Arriving,
        n: V3<D>,
        corners: [V3<D>; 3],
        b: [D; 2],
    ) -> V3<D> {
        let (value, db) = (b.map(|b| b.value), b.map(|b| b.tangent));
        let Some(maps) = self.view.relief_maps(vertices, value) else {
            return n;
        };
        let change = |relief: &Relief, turned: &Turned| self.motion.relief(relief, turned);
        let [map, rises] = self.view.relief_change(vertices, value, db, change);
        let slopes = maps.slopes.map(|of| of.map(constant));
        let [du, dv] = by_uv(corners, slopes);
        let pictures = [dual_vector(maps.map, map), dual_vector(maps.rises, rises)];
        let facing = constant(vertices.facing);
        let signs = maps.signs.map(constant);
        let local = local(
            (n, facing),
            [du, dv],
            pictures,
            lane_mask(maps.bumps),
            signs,
        );
        let turned = relief_normal(n, du, chain.direction, local);
        V3::select(lane_mask(vertices.kinds.relief), turned, n)
    }

    /// The part of what is sent toward or from `w` that turned surfaces do not hide.
    pub(crate) fn shown(&self, here: &MovingVertex, w: V3<D>, value: V3<D>) -> V3<D> {
        let relief = here.vertices.kinds.relief;
        if relief == 0 {
            return value;
        }
        let shown = value * relief_shadow(here.base_n, here.n, w);
        V3::select(lane_mask(relief), shown, value)
    }
}
