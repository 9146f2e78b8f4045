//! Between a vertex of a path and the triangle it lies on, in the backward sweep.

use crate::adjoint::bsdf::consistent_normal_adjoint;
use crate::adjoint::normal::{face_normal_adjoint, shading_normal_adjoint};
use crate::adjoint::triangle::triangle_hit_adjoint;
use crate::gradient::path::backward::{BackwardSweep, Returning, Solved};
use crate::gradient::path::bars::VertexBars;
use crate::gradient::scene::backward::TileSums;
use crate::kernels::bsdf::consistent_normal;
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::rays::{lane_mask, lane_of, masked};
use crate::paths::store::Vertices;
use crate::paths::surface::layers::tangent;
use crate::paths::surface::relief::turned;
use glam::{DVec3, Vec3};

impl BackwardSweep<'_> {
    /// The vertex as it was when the path was traced.
    pub(crate) fn solve<'v>(&self, vertices: &'v Vertices) -> Option<Solved<'v>> {
        if vertices.hit == 0 {
            return None;
        }
        let geometry = self.view.geometry;
        let ids = geometry.corners(&vertices.triangle);
        let corners = geometry.gather_positions(&ids);
        let [v0, v1, v2] = corners;
        let (o, d) = (vertices.origin, vertices.direction);
        let (t, b1, b2) = triangle_hit(o, d, v0, v1, v2);
        let smooth = self.view.smooth_lanes(&vertices.triangle);
        let mut n = face_normal(v0, v1, v2);
        if smooth != 0 {
            let [n0, n1, n2] = geometry.gather_normals(&ids);
            n = V3::select(lane_mask(smooth), shading_normal(n0, n1, n2, b1, b2), n);
        }
        let raw_n = n * vertices.facing;
        let special = vertices.kinds.special();
        let relief = vertices.kinds.relief;
        let kept_above = (special | relief) & smooth;
        let n = if kept_above != 0 {
            V3::select(lane_mask(kept_above), consistent_normal(raw_n, d), raw_n)
        } else {
            raw_n
        };
        let base_n = n;
        let maps = self.view.relief_maps(vertices, [b1, b2]);
        let n = match &maps {
            None => n,
            Some(maps) => turned(vertices, n, corners, maps),
        };
        let interface = (special | relief != 0).then(|| self.view.interface(vertices, [b1, b2]));
        let layers = (vertices.kinds.layered() != 0).then(|| {
            let grain = self.view.grain(&vertices.triangle);
            let along = tangent(corners, grain);
            let layers = self.view.layers(vertices, [b1, b2], along);
            layers.map(|l| (l, grain))
        });
        Some(Solved {
            vertices,
            t,
            b: [b1, b2],
            x: o + d * t,
            n,
            base_n,
            raw_n,
            relief: maps,
            kept_above,
            ids,
            corners,
            smooth,
            interface,
            layers: layers.flatten(),
        })
    }

    /// From position and normal to the triangle's vertices and the arriving ray.
    pub(crate) fn surface(
        &self,
        here: &Solved,
        bars: &VertexBars,
        back: &mut Returning,
        sums: &mut TileSums,
    ) {
        let vertices = here.vertices;
        let (o, d) = (vertices.origin, vertices.direction);
        let [v0, v1, v2] = here.corners;
        let zero = V3::splat(0.0);
        let mut d_bar = bars.direction;
        let mut n_bar = bars.n;
        let mut b_bar = bars.b;
        let mut relief_bar = [zero; 3];
        if let Some(maps) = &here.relief {
            let turned = self.relief(here, maps, bars.n, sums);
            n_bar = turned.n + bars.base_n;
            d_bar = d_bar + turned.direction;
            relief_bar = turned.corners;
            b_bar = [b_bar[0] + turned.b[0], b_bar[1] + turned.b[1]];
        }
        if here.kept_above != 0 {
            let (n, direction) = consistent_normal_adjoint(here.raw_n, d, n_bar);
            n_bar = V3::select(lane_mask(here.kept_above), n, n_bar);
            d_bar = d_bar + masked(here.kept_above, direction);
        }
        let n_bar = n_bar * vertices.facing;
        let smooth = lane_mask(here.smooth);
        let mut v_bar = [zero; 3];
        let [mut b1_bar, mut b2_bar] = b_bar;
        if here.smooth != u32::MAX >> (32 - LANES) {
            let flat_bar = V3::select(smooth, zero, n_bar);
            v_bar = face_normal_adjoint(v0, v1, v2, flat_bar).into();
        }
        if here.smooth != 0 {
            let [n0, n1, n2] = self.view.geometry.gather_normals(&here.ids);
            let (m0, m1, m2, b1, b2) = shading_normal_adjoint(
                n0,
                n1,
                n2,
                here.b[0],
                here.b[1],
                V3::select(smooth, n_bar, zero),
            );
            let none = Lane::splat(0.0);
            b1_bar += <Lane as Real>::select(smooth, b1, none);
            b2_bar += <Lane as Real>::select(smooth, b2, none);
            self.scatter_normals(here, [m0, m1, m2], sums);
        }
        if let (Some((_, [a, b])), Some(l)) = (&here.layers, &bars.layers) {
            v_bar[0] = v_bar[0] - l.tangent * (*a + *b);
            v_bar[1] = v_bar[1] + l.tangent * *a;
            v_bar[2] = v_bar[2] + l.tangent * *b;
        }
        for (sum, bar) in v_bar.iter_mut().zip(relief_bar) {
            *sum = *sum + bar;
        }
        let t_bar = d.dot(bars.x);
        let (o_hit, d_hit, w0, w1, w2) =
            triangle_hit_adjoint(o, d, v0, v1, v2, (t_bar, b1_bar, b2_bar));
        for (sum, value) in v_bar.iter_mut().zip([w0, w1, w2]) {
            *sum = *sum + value;
        }
        self.scatter(&vertices.triangle, &here.ids, v_bar, vertices.hit, sums);
        let hit = vertices.hit;
        back.origin = back.origin + masked(hit, bars.x + o_hit);
        back.direction = back.direction + masked(hit, bars.x * here.t + d_hit + d_bar);
    }

    /// Adds to the vertices of the triangles in the lanes of `bits`, where they are wanted.
    pub(crate) fn scatter(
        &self,
        triangle: &[u32; LANES],
        ids: &[[u32; 3]; LANES],
        bars: [V3<Lane>; 3],
        bits: u32,
        sums: &mut TileSums,
    ) {
        if !triangle
            .iter()
            .any(|&t| self.wanted.moves(self.view.geometry, t))
        {
            return;
        }
        let bars = bars.map(|v| [v.x.to_array(), v.y.to_array(), v.z.to_array()]);
        for lane in (0..LANES).filter(|&l| bits >> l & 1 == 1) {
            if self.wanted.moves(self.view.geometry, triangle[lane]) {
                let mesh = self.view.geometry.mesh_of_triangle[triangle[lane] as usize] as usize;
                for (bar, &v) in bars.iter().zip(&ids[lane]) {
                    let value = Vec3::new(bar[0][lane], bar[1][lane], bar[2][lane]);
                    sums.add_position(mesh, v, value);
                }
            }
        }
    }

    fn scatter_normals(&self, here: &Solved, bars: [V3<Lane>; 3], sums: &mut TileSums) {
        let vertices = here.vertices;
        for lane in (0..LANES).filter(|&l| here.smooth & vertices.hit & 1 << l != 0) {
            if self
                .wanted
                .moves(self.view.geometry, vertices.triangle[lane])
            {
                for (bar, &v) in bars.iter().zip(&here.ids[lane]) {
                    sums.add_normal(v, lane_of(*bar, lane));
                }
            }
        }
    }

    pub(crate) fn scatter_vertex(&self, vertex: u32, bar: DVec3, sums: &mut TileSums) {
        // Vertices are numbered mesh by mesh.
        let mesh = self
            .view
            .geometry
            .first_vertex
            .partition_point(|&f| f <= vertex)
            - 1;
        if self.wanted.mesh[mesh] {
            sums.add_position(mesh, vertex, bar.as_vec3());
        }
    }
}
