//! The backward sweep through chains of smooth surfaces.

use crate::adjoint::relief::{bump_adjoint, relief_normal_adjoint};
use crate::adjoint::smooth::{smooth_hit_adjoint, smooth_turn_adjoint};
use crate::discontinuity::boundary::{dvec3, vector};
use crate::gradient::path::backward::BackwardSweep;
use crate::gradient::scene::backward::TileSums;
use crate::kernels::smooth::smooth_hit;
use crate::lanes::V3;
use crate::paths::chain::{
    AtRest, ChainScene, eta_texture, is_shaded, relief_place, through, vertex_normals,
};
use crate::paths::chain_relief::ReliefPlace;
use crate::paths::chain_vertex::ChainVertex;
use crate::paths::surface::relief::by_uv;
use glam::{DVec3, Vec3};

/// A normal before a picture turns it, and what that depends on besides.
struct Unturned {
    n: V3<f64>,
    direction: V3<f64>,
    corners: [V3<f64>; 3],
}

/// Cotangents of what a turned normal is made of.
struct TurnedBars {
    /// Of the normal before.
    n: V3<f64>,
    direction: V3<f64>,
    corners: [V3<f64>; 3],
    /// Of the barycentrics.
    b: [f64; 2],
}

impl BackwardSweep<'_> {
    /// The rays of a chain: the first one, and that after each surface.
    pub(super) fn along(
        &self,
        chain: &[ChainVertex],
        first: (DVec3, DVec3),
    ) -> Vec<(DVec3, DVec3)> {
        let mut rays = vec![first];
        let mut ray = (vector(first.0), vector(first.1));
        for vertex in chain.chunks(1) {
            ray = through(self.view, vertex, ray, &AtRest(self.view));
            rays.push((dvec3(ray.0), dvec3(ray.1)));
        }
        rays
    }

    /// Cotangents of the ray that meets a smooth surface from those of the next one; those of the
    /// surface are added.
    pub(super) fn back_through(
        &self,
        vertex: &ChainVertex,
        (o, d): (DVec3, DVec3),
        (x_bar, next_bar): (DVec3, DVec3),
        sums: &mut TileSums,
    ) -> (DVec3, DVec3) {
        let (view, triangle) = (self.view, vertex.triangle);
        let geometry = view.geometry;
        let (o, d) = (vector(o), vector(d));
        let ids = geometry.triangles[triangle as usize];
        let corners: [V3<f64>; 3] = ids.map(|v| AtRest(view).point(v));
        let normals = vertex_normals(geometry, triangle).map(vector);
        let (facing, is_shaded) = (vertex.facing(), is_shaded(geometry, triangle));
        let (_, n, b1, b2) = smooth_hit(o, d, corners, normals, facing, is_shaded);
        let place = relief_place(vertex, view, [b1, b2]);
        let before = Unturned {
            n,
            direction: d,
            corners,
        };
        let turned = place.as_ref().map_or(n, |place| {
            let numbers = place.numbers([b1, b2], Vec3::ZERO);
            place.turn(n, d, corners, numbers)
        });
        let texture = eta_texture(vertex, view);
        let eta = texture.map_or(1.0, |t| f64::from(view.scene.constant(t)[0]));
        let (n_bar, turn_bar, ratio_bar) = smooth_turn_adjoint(
            turned,
            d,
            vertex.ratio(eta),
            vertex.is_reflected(),
            vertex.is_refracted(),
            vector(next_bar),
        );
        let none = V3::splat(0.0);
        let bars = match &place {
            Some(place) => self.back_through_relief(place, &before, [b1, b2], n_bar, sums),
            None => TurnedBars {
                n: n_bar,
                direction: none,
                corners: [none; 3],
                b: [0.0; 2],
            },
        };
        let hit_bars = (vector(x_bar), bars.n, bars.b[0], bars.b[1]);
        let (o_bar, d_bar, corner_bars, normal_bars, _) =
            smooth_hit_adjoint(o, d, corners, normals, facing, is_shaded, hit_bars);
        for ((&v, bar), more) in ids.iter().zip(corner_bars).zip(bars.corners) {
            self.scatter_vertex(v, dvec3(bar + more), sums);
        }
        if is_shaded && self.wanted.moves(geometry, triangle) {
            for (&v, bar) in ids.iter().zip(normal_bars) {
                sums.add_normal(v, dvec3(bar).as_vec3());
            }
        }
        if let Some(texture) = texture {
            let by_eta = if vertex.from_front {
                1.0
            } else {
                -1.0 / (eta * eta)
            };
            let bar = Vec3::new((ratio_bar * by_eta) as f32, 0.0, 0.0);
            sums.add_texel(self.wanted, texture, 0, bar);
        }
        (dvec3(o_bar), dvec3(d_bar + turn_bar + bars.direction))
    }

    /// From the cotangent of a turned normal to what it is made of; those of the picture are added.
    fn back_through_relief(
        &self,
        place: &ReliefPlace,
        before: &Unturned,
        b: [f64; 2],
        n_bar: V3<f64>,
        sums: &mut TileSums,
    ) -> TurnedBars {
        let Unturned {
            n,
            direction,
            corners,
        } = *before;
        let (relief, slopes) = (place.relief, place.slopes);
        let [du, dv] = by_uv(corners, slopes);
        let numbers = place.numbers(b, Vec3::ZERO);
        let local = place.local(n, [du, dv], numbers);
        let (mut base, mut du_bar, direction, local_bar) =
            relief_normal_adjoint(n, du, direction, local, n_bar);
        let [along, across] = place.signs;
        let mut bar = V3::new(local_bar.x * along, local_bar.y * across, local_bar.z);
        let mut dv_bar = V3::splat(0.0);
        if relief.bumps.is_some() {
            let facing = place.facing;
            let (up, along_u, along_v, rises) = bump_adjoint(n * facing, du, dv, numbers, bar);
            base = base + up * facing;
            du_bar = du_bar + along_u;
            (dv_bar, bar) = (along_v, rises);
        }
        let [first, second] =
            [0, 1].map(|edge| du_bar * slopes[0][edge] + dv_bar * slopes[1][edge]);
        let bar = dvec3(bar).as_vec3();
        TurnedBars {
            n: base,
            direction,
            corners: [-(first + second), first, second],
            b: self
                .relief_picture(relief, &place.turned, bar, sums)
                .map(f64::from),
        }
    }
}
