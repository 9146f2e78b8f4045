//! The backward sweep through chains of smooth surfaces.

use crate::adjoint::smooth::smooth_ray_adjoint;
use crate::discontinuity::boundary::{dvec3, vector};
use crate::gradient::path::backward::BackwardSweep;
use crate::gradient::scene::backward::TileSums;
use crate::paths::chain::{eta_texture, is_shaded, through, vertex_normals};
use crate::paths::chain_vertex::ChainVertex;
use glam::{DVec3, Vec3};

impl BackwardSweep<'_> {
    /// The rays of a chain: the first one, and that after each surface.
    pub(super) fn along(
        &self,
        chain: &[ChainVertex],
        first: (DVec3, DVec3),
    ) -> Vec<(DVec3, DVec3)> {
        let geometry = self.view.geometry;
        let mut rays = vec![first];
        let mut ray = (vector(first.0), vector(first.1));
        for vertex in chain.chunks(1) {
            ray = through(
                self.view,
                vertex,
                ray,
                |v| vector(geometry.positions[v as usize].as_dvec3()),
                |v| vector(geometry.normals[v as usize].as_dvec3()),
                |texture| f64::from(self.view.scene.constant(texture)[0]),
            );
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
        let corners = geometry.triangles[triangle as usize];
        let texture = eta_texture(vertex, view);
        let eta = texture.map_or(1.0, |t| f64::from(view.scene.constant(t)[0]));
        let (o_bar, d_bar, corner_bars, normal_bars, _, ratio_bar) = smooth_ray_adjoint(
            vector(o),
            vector(d),
            corners.map(|v| vector(geometry.positions[v as usize].as_dvec3())),
            vertex_normals(geometry, triangle).map(vector),
            vertex.facing(),
            vertex.ratio(eta),
            is_shaded(geometry, triangle),
            vertex.is_reflected(),
            vertex.is_refracted(),
            (vector(x_bar), vector(next_bar)),
        );
        for (&v, bar) in corners.iter().zip(corner_bars) {
            self.scatter_vertex(v, dvec3(bar), sums);
        }
        if is_shaded(geometry, triangle) && self.wanted.moves(geometry, triangle) {
            for (&v, bar) in corners.iter().zip(normal_bars) {
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
        (dvec3(o_bar), dvec3(d_bar))
    }
}
