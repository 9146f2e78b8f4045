//! The adjoint sweep: from stored vertices, last to first, to the cotangents of everything that was asked for.
//!
//! No ray is traced. Each vertex is solved again from its stored ray, the generated adjoints of the kernels carry the
//! cotangents of position, normal, direction and throughput toward the camera, and what reaches a triangle's vertices, a
//! colour or the camera is added to the tile's sums.

use super::accumulator::{TileSums, Wanted, sum_lanes};
use super::forward::range;
use crate::adjoint::camera::camera_direction_adjoint;
use crate::adjoint::frame::direction_from_local_adjoint;
use crate::adjoint::light::triangle_irradiance_adjoint;
use crate::adjoint::normal::{face_normal_adjoint, shading_normal_adjoint};
use crate::adjoint::triangle::triangle_hit_adjoint;
use crate::kernels::frame::direction_from_local;
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{LANES, Lane, Mask, Real, V3};
use crate::paths::bounce_cells::BounceCrossing;
use crate::paths::camera::splat;
use crate::paths::store::{FilmCrossing, LightCrossing, TileStore, Vertices, lane_mask, masked};
use crate::paths::tracer::{Tracer, from_lanes, lane_of};
use crate::scene::Rgb;
use crate::trace::geometry::{NO_TRIANGLE, gather};
use crate::warp::boundary::{dvec3, vector};
use glam::{DVec3, Vec3};

/// Runs adjoint sweeps over a tile's store.
pub struct ReverseSweep<'a> {
    pub tracer: &'a Tracer<'a>,
    pub wanted: &'a Wanted,
    /// Whether the silhouettes' motion counts.
    pub visibility: bool,
}

/// A vertex as it was, with what its adjoints need.
struct Solved {
    t: Lane,
    b1: Lane,
    b2: Lane,
    x: V3<Lane>,
    n: V3<Lane>,
    ids: [[u32; 3]; LANES],
    corners: [V3<Lane>; 3],
    smooth: u32,
}

/// Cotangents that a vertex hands to the one before it.
#[derive(Clone, Copy)]
struct Chain {
    origin: V3<Lane>,
    direction: V3<Lane>,
    throughput: V3<Lane>,
    /// Of the previous vertex's position and normal, from emission that its bounce found.
    x: V3<Lane>,
    n: V3<Lane>,
}

impl Chain {
    fn zero() -> Self {
        let zero = V3::splat(0.0);
        Self {
            origin: zero,
            direction: zero,
            throughput: zero,
            x: zero,
            n: zero,
        }
    }
}

impl ReverseSweep<'_> {
    /// Adds the gradient of Σ radiance_bar · radiance over the lanes of a packet, whose camera rays go through the
    /// film points (`u`, `v`).
    pub fn add_path(
        &self,
        store: &TileStore,
        packet: usize,
        [u, v]: [Lane; 2],
        radiance_bar: V3<Lane>,
        sums: &mut TileSums,
    ) {
        let path = store.path(packet);
        let mut solved: [Option<Solved>; 2] = [None, None];
        let mut chain = Chain::zero();
        for (k, vertices) in path.iter().enumerate().rev() {
            let here = solved[1].take().or_else(|| self.solve(vertices));
            let before = k.checked_sub(1).and_then(|k| self.solve(&path[k]));
            chain = self.vertex(
                store,
                vertices,
                here.as_ref(),
                before.as_ref(),
                radiance_bar,
                chain,
                sums,
            );
            solved[1] = before;
        }
        if self.wanted.camera {
            let bits = path[0].hit;
            let camera = &self.tracer.camera;
            let (px, py) = camera.film_to_camera(u, v);
            let [x, y, z] = camera.axes.map(splat);
            let tan = Lane::splat(camera.tan_half_x_fov as f32);
            let (x, y, z, tan, _, _) =
                camera_direction_adjoint(x, y, z, tan, px, py, chain.direction);
            sums.camera.origin += sum_lanes(chain.origin, bits);
            for (sum, bar) in sums.camera.axes.iter_mut().zip([x, y, z]) {
                *sum += sum_lanes(bar, bits);
            }
            sums.camera.tan_half_x_fov += sum_lanes(
                V3 {
                    x: tan,
                    y: tan,
                    z: tan,
                },
                bits,
            )
            .x;
        }
    }

    fn solve(&self, vertices: &Vertices) -> Option<Solved> {
        if vertices.hit == 0 {
            return None;
        }
        let geometry = self.tracer.geometry;
        let ids = geometry.corners(&vertices.triangle);
        let corners = geometry.gather_positions(&ids);
        let [v0, v1, v2] = corners;
        let (o, d) = (vertices.origin, vertices.direction);
        let (t, b1, b2) = triangle_hit(o, d, v0, v1, v2);
        let smooth = self.tracer.smooth_lanes(&vertices.triangle);
        let mut n = face_normal(v0, v1, v2);
        if smooth != 0 {
            let [n0, n1, n2] = geometry.gather_normals(&ids);
            n = V3::select(lane_mask(smooth), shading_normal(n0, n1, n2, b1, b2), n);
        }
        Some(Solved {
            t,
            b1,
            b2,
            x: o + d * t,
            n: n * vertices.facing,
            ids,
            corners,
            smooth,
        })
    }

    /// One vertex: `after` holds the cotangents that the next vertex handed back.
    #[allow(clippy::too_many_arguments)]
    fn vertex(
        &self,
        store: &TileStore,
        vertices: &Vertices,
        here: Option<&Solved>,
        before: Option<&Solved>,
        radiance_bar: V3<Lane>,
        after: Chain,
        sums: &mut TileSums,
    ) -> Chain {
        let mut back = Chain::zero();
        if vertices.escaped != 0 {
            self.escape(vertices, radiance_bar, &mut back, sums);
        }
        let Some(here) = here else { return back };
        let (mut x_bar, mut n_bar) = (after.x, after.n);
        // T' = T·ρ·s of the next vertex.
        let on = after.throughput * vertices.survival;
        let mut reflectance_bar = on.times(vertices.throughput);
        back.throughput = back.throughput + masked(vertices.hit, on.times(vertices.reflectance));

        if !self.tracer.lights.is_empty() {
            self.emission(vertices, here, before, radiance_bar, &mut back, sums);
            let (x, n, rho) = self.light_sample(vertices, here, radiance_bar, &mut back, sums);
            (x_bar, n_bar, reflectance_bar) = (x_bar + x, n_bar + n, reflectance_bar + rho);
        }
        if self.wanted.colours() {
            self.add_reflectance(vertices, reflectance_bar, sums);
        }
        if !self.wanted.geometry() {
            return back;
        }
        if self.visibility {
            self.crossings(
                store,
                vertices,
                here,
                radiance_bar,
                &mut x_bar,
                &mut n_bar,
                sums,
            );
        }
        // The next ray leaves from x along its local direction in this frame.
        x_bar = x_bar + after.origin;
        if vertices.survival.gt(Lane::splat(0.0)).any() {
            let [lx, ly, lz] = vertices.local;
            let (n, _, _, _) = direction_from_local_adjoint(here.n, lx, ly, lz, after.direction);
            n_bar = n_bar + n;
        }
        self.surface(vertices, here, x_bar, n_bar, &mut back, sums);
        back
    }

    fn escape(
        &self,
        vertices: &Vertices,
        radiance_bar: V3<Lane>,
        back: &mut Chain,
        sums: &mut TileSums,
    ) {
        let radiance = self
            .tracer
            .scene
            .environment
            .as_ref()
            .map_or([0.0; 3], |e| self.tracer.scene.constant(e.radiance));
        let environment = splat(Vec3::from(radiance));
        back.throughput = masked(vertices.escaped, radiance_bar.times(environment));
        if let (true, Some(environment)) = (self.wanted.colours(), &self.tracer.scene.environment) {
            let sum = sum_lanes(radiance_bar.times(vertices.throughput), vertices.escaped);
            sums.add_texel(self.wanted, environment.radiance, 0, sum.as_vec3());
        }
    }

    /// See `forward::ForwardSweep::emission`.
    fn emission(
        &self,
        vertices: &Vertices,
        here: &Solved,
        before: Option<&Solved>,
        radiance_bar: V3<Lane>,
        back: &mut Chain,
        sums: &mut TileSums,
    ) {
        let zero = Lane::splat(0.0);
        let weight = vertices.emission_weight;
        if !(weight.gt(zero) & lane_mask(vertices.hit)).any() {
            return;
        }
        let emitted = self.tracer.emission(vertices) * weight;
        back.throughput = back.throughput + masked(vertices.hit, radiance_bar.times(emitted));
        let by_radiance = radiance_bar.times(vertices.throughput) * weight;
        if self.wanted.colours() {
            for lane in (0..LANES).filter(|&l| vertices.hit >> l & 1 == 1) {
                let mesh = self.tracer.geometry.mesh_of_triangle[vertices.triangle[lane] as usize]
                    as usize;
                if let Some(light) = self.tracer.lights.of_mesh[mesh]
                    && self.tracer.sees_front(vertices, lane)
                {
                    let texture = self.tracer.scene.area_lights[light as usize].radiance;
                    sums.add_texel(self.wanted, texture, 0, lane_of(by_radiance, lane));
                }
            }
        }
        let (Some(from), true) = (before, self.wanted.geometry()) else {
            return;
        };
        let [q0, q1, q2] = here.corners;
        let irradiance = crate::kernels::light::triangle_irradiance(
            from.x, from.n, q0, q1, q2, here.b1, here.b2,
        );
        let total = radiance_bar.times(vertices.throughput).times(emitted);
        let emits = weight.gt(zero) & irradiance.gt(zero) & lane_mask(vertices.hit);
        let relative_bar = total.x + total.y + total.z;
        let irradiance_bar = <Lane as Real>::select(emits, relative_bar / irradiance, zero);
        let (x, n, q0, q1, q2, _, _) = triangle_irradiance_adjoint(
            from.x,
            from.n,
            q0,
            q1,
            q2,
            here.b1,
            here.b2,
            irradiance_bar,
        );
        let bits = emits.to_bits();
        (back.x, back.n) = (masked(bits, x), masked(bits, n));
        self.scatter(&vertices.triangle, &here.ids, [q0, q1, q2], bits, sums);
    }

    /// Returns the cotangents of position, normal and reflectance.
    fn light_sample(
        &self,
        vertices: &Vertices,
        here: &Solved,
        radiance_bar: V3<Lane>,
        back: &mut Chain,
        sums: &mut TileSums,
    ) -> (V3<Lane>, V3<Lane>, V3<Lane>) {
        let zero = V3::splat(0.0);
        let light = &vertices.light;
        let lit = light.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return (zero, zero, zero);
        }
        let bits = lit.to_bits();
        let emitted = self.tracer.light_radiance(&light.patch);
        let scale = light.irradiance * light.weight;
        let by_reflectance = masked(
            bits,
            radiance_bar.times(vertices.throughput).times(emitted) * scale,
        );
        let by_throughput = masked(
            bits,
            radiance_bar.times(vertices.reflectance).times(emitted) * scale,
        );
        back.throughput = back.throughput + by_throughput;
        let colour = radiance_bar
            .times(vertices.throughput)
            .times(vertices.reflectance);
        if self.wanted.colours() {
            let by_radiance = colour * scale;
            for lane in (0..LANES).filter(|&l| bits >> l & 1 == 1) {
                let index = self.tracer.lights.patches[light.patch[lane] as usize].light as usize;
                let texture = self.tracer.scene.area_lights[index].radiance;
                sums.add_texel(self.wanted, texture, 0, lane_of(by_radiance, lane));
            }
        }
        if !self.wanted.geometry() {
            return (zero, zero, by_reflectance);
        }
        let by_irradiance = colour.times(emitted) * light.weight;
        let irradiance_bar = by_irradiance.x + by_irradiance.y + by_irradiance.z;
        let (ids, [b1, b2]) =
            self.tracer
                .patch_corners(&light.patch, &light.s.to_array(), &light.r.to_array());
        let [q0, q1, q2] = gather(&ids, |v, _| self.tracer.geometry.positions[v as usize]);
        let (x, n, q0, q1, q2, _, _) =
            triangle_irradiance_adjoint(here.x, here.n, q0, q1, q2, b1, b2, irradiance_bar);
        let triangle = light.patch.map(|p| self.light_triangle(p));
        self.scatter(&triangle, &ids, [q0, q1, q2], bits, sums);
        (masked(bits, x), masked(bits, n), by_reflectance)
    }

    /// Any triangle of the mesh that a patch belongs to.
    fn light_triangle(&self, patch: u32) -> u32 {
        let light = self.tracer.lights.patches[patch as usize].light as usize;
        self.tracer.geometry.first_triangle[self.tracer.scene.area_lights[light].mesh]
    }

    fn add_reflectance(&self, vertices: &Vertices, bar: V3<Lane>, sums: &mut TileSums) {
        let facing = vertices.facing.to_array();
        for lane in (0..LANES).filter(|&l| vertices.hit >> l & 1 == 1) {
            let mesh =
                self.tracer.geometry.mesh_of_triangle[vertices.triangle[lane] as usize] as usize;
            let index = self.tracer.scene.meshes[mesh].material;
            let is_lit = self.tracer.scene.materials[index].two_sided || facing[lane] > 0.0;
            let colour = self.tracer.scene.materials[index].bsdf.colour();
            if let (true, Some(texture)) = (is_lit, colour) {
                sums.add_texel(self.wanted, texture, 0, lane_of(bar, lane));
            }
        }
    }

    /// Shadow edges and silhouettes over the hemisphere.
    #[allow(clippy::too_many_arguments)]
    fn crossings(
        &self,
        store: &TileStore,
        vertices: &Vertices,
        here: &Solved,
        radiance_bar: V3<Lane>,
        x_bar: &mut V3<Lane>,
        n_bar: &mut V3<Lane>,
        sums: &mut TileSums,
    ) {
        let lights = &store.light_crossings[range(vertices.crossings)];
        let bounces = &store.bounce_crossings[range(vertices.bounce_crossings)];
        if lights.is_empty() && bounces.is_empty() {
            return;
        }
        let (mut x, mut n) = ([Vec3::ZERO; LANES], [Vec3::ZERO; LANES]);
        for crossing in lights {
            let lane = crossing.lane as usize;
            x[lane] +=
                self.light_crossing(vertices, crossing, here, lane_of(radiance_bar, lane), sums);
        }
        for crossing in bounces {
            let lane = crossing.lane as usize;
            let (dx, dn) =
                self.bounce_crossing(vertices, crossing, here, lane_of(radiance_bar, lane), sums);
            x[lane] += dx;
            n[lane] += dn;
        }
        *x_bar = *x_bar + from_lanes(&x);
        *n_bar = *n_bar + from_lanes(&n);
    }

    fn light_crossing(
        &self,
        vertices: &Vertices,
        crossing: &LightCrossing,
        here: &Solved,
        bar: Vec3,
        sums: &mut TileSums,
    ) -> Vec3 {
        let lane = crossing.lane as usize;
        let Some(weight) = crossing.radiance_per_side(self.tracer, vertices, lane_of(here.n, lane))
        else {
            return Vec3::ZERO;
        };
        let side_bar = bar.as_dvec3().dot(DVec3::from(weight));
        let x = lane_of(here.x, lane).as_dvec3();
        let geometry = self.tracer.geometry;
        let (ids, [b1, b2]) = self.tracer.lights.patches[crossing.patch as usize]
            .vertices_at(crossing.at[0] as f32, crossing.at[1] as f32);
        let b = [1.0 - b1 as f64 - b2 as f64, b1 as f64, b2 as f64];
        let y: DVec3 = ids
            .iter()
            .zip(b)
            .map(|(&v, b)| geometry.positions[v as usize].as_dvec3() * b)
            .sum();
        let (o_bar, d_bar) =
            crossing
                .boundary
                .side_adjoint(geometry, x, y - x, side_bar, |v, bar| {
                    self.scatter_vertex(v, bar, sums)
                });
        for (&v, b) in ids.iter().zip(b) {
            self.scatter_vertex(v, d_bar * b, sums);
        }
        finite(o_bar - d_bar)
    }

    fn bounce_crossing(
        &self,
        vertices: &Vertices,
        crossing: &BounceCrossing,
        here: &Solved,
        bar: Vec3,
        sums: &mut TileSums,
    ) -> (Vec3, Vec3) {
        let lane = crossing.lane as usize;
        let Some(weight) = crossing.radiance_per_side(self.tracer, vertices) else {
            return (Vec3::ZERO, Vec3::ZERO);
        };
        let side_bar = bar.as_dvec3().dot(DVec3::from(weight));
        let (x, n) = (
            lane_of(here.x, lane).as_dvec3(),
            vector(lane_of(here.n, lane).as_dvec3()),
        );
        let [lx, ly, lz] = crossing.local;
        let d = dvec3(direction_from_local(n, lx, ly, lz));
        let (o_bar, d_bar) =
            crossing
                .boundary
                .side_adjoint(self.tracer.geometry, x, d, side_bar, |v, bar| {
                    self.scatter_vertex(v, bar, sums)
                });
        let (n_bar, _, _, _) = direction_from_local_adjoint(n, lx, ly, lz, vector(d_bar));
        (finite(o_bar), finite(dvec3(n_bar)))
    }

    /// From position and normal to the triangle's vertices and the arriving ray.
    fn surface(
        &self,
        vertices: &Vertices,
        here: &Solved,
        x_bar: V3<Lane>,
        n_bar: V3<Lane>,
        back: &mut Chain,
        sums: &mut TileSums,
    ) {
        let (o, d) = (vertices.origin, vertices.direction);
        let [v0, v1, v2] = here.corners;
        let n_bar = n_bar * vertices.facing;
        let zero = V3::splat(0.0);
        let smooth = lane_mask(here.smooth);
        let mut v_bar = [zero; 3];
        let (mut b1_bar, mut b2_bar) = (Lane::splat(0.0), Lane::splat(0.0));
        if here.smooth != u32::MAX >> (32 - LANES) {
            let flat_bar = V3::select(smooth, zero, n_bar);
            v_bar = face_normal_adjoint(v0, v1, v2, flat_bar).into();
        }
        if here.smooth != 0 {
            let [n0, n1, n2] = self.tracer.geometry.gather_normals(&here.ids);
            let (m0, m1, m2, b1, b2) = shading_normal_adjoint(
                n0,
                n1,
                n2,
                here.b1,
                here.b2,
                V3::select(smooth, n_bar, zero),
            );
            let none = Lane::splat(0.0);
            b1_bar = <Lane as Real>::select(smooth, b1, none);
            b2_bar = <Lane as Real>::select(smooth, b2, none);
            self.scatter_normals(vertices, here, [m0, m1, m2], sums);
        }
        let t_bar = d.dot(x_bar);
        let (o_hit, d_hit, w0, w1, w2) =
            triangle_hit_adjoint(o, d, v0, v1, v2, (t_bar, b1_bar, b2_bar));
        for (sum, value) in v_bar.iter_mut().zip([w0, w1, w2]) {
            *sum = *sum + value;
        }
        self.scatter(&vertices.triangle, &here.ids, v_bar, vertices.hit, sums);
        back.origin = masked(vertices.hit, x_bar + o_hit);
        back.direction = masked(vertices.hit, x_bar * here.t + d_hit);
    }

    /// Adds to the vertices of the triangles in the lanes of `bits`, where they are wanted.
    fn scatter(
        &self,
        triangle: &[u32; LANES],
        ids: &[[u32; 3]; LANES],
        bars: [V3<Lane>; 3],
        bits: u32,
        sums: &mut TileSums,
    ) {
        if !triangle
            .iter()
            .any(|&t| self.wanted.moves(self.tracer.geometry, t))
        {
            return;
        }
        let bars = bars.map(|v| [v.x.to_array(), v.y.to_array(), v.z.to_array()]);
        for lane in (0..LANES).filter(|&l| bits >> l & 1 == 1) {
            if self.wanted.moves(self.tracer.geometry, triangle[lane]) {
                for (bar, &v) in bars.iter().zip(&ids[lane]) {
                    let value = Vec3::new(bar[0][lane], bar[1][lane], bar[2][lane]);
                    if value.is_finite() {
                        sums.positions.add(v, value);
                    }
                }
            }
        }
    }

    fn scatter_normals(
        &self,
        vertices: &Vertices,
        here: &Solved,
        bars: [V3<Lane>; 3],
        sums: &mut TileSums,
    ) {
        for lane in (0..LANES).filter(|&l| here.smooth & vertices.hit & 1 << l != 0) {
            if self
                .wanted
                .moves(self.tracer.geometry, vertices.triangle[lane])
            {
                for (bar, &v) in bars.iter().zip(&here.ids[lane]) {
                    let value = lane_of(*bar, lane);
                    if value.is_finite() {
                        sums.normals.add(v, value);
                    }
                }
            }
        }
    }

    fn scatter_vertex(&self, vertex: u32, bar: DVec3, sums: &mut TileSums) {
        // Vertices are numbered mesh by mesh.
        let mesh = self
            .tracer
            .geometry
            .first_vertex
            .partition_point(|&f| f <= vertex)
            - 1;
        if self.wanted.mesh[mesh] && bar.is_finite() {
            sums.positions.add(vertex, bar.as_vec3());
        }
    }

    /// A film crossing, with the cotangent of what it adds at its place.
    pub fn add_film_crossing(&self, crossing: &FilmCrossing, bar: Rgb, sums: &mut TileSums) {
        let Some(velocity) = crossing.velocity_per_side(self.tracer) else {
            return;
        };
        let jump = DVec3::from(crossing.jump.map(f64::from));
        let side_bar = jump.dot(DVec3::from(bar.map(f64::from))) * velocity;
        let camera = &self.tracer.camera;
        let [u, v] = crossing.at;
        let d = dvec3(camera.direction(u, v));
        let (o_bar, d_bar) = crossing.boundary.side_adjoint(
            self.tracer.geometry,
            camera.origin.as_dvec3(),
            d,
            side_bar,
            |v, bar| {
                self.scatter_vertex(v, bar, sums);
            },
        );
        if self.wanted.camera && o_bar.is_finite() && d_bar.is_finite() {
            let (px, py) = camera.film_to_camera(u, v);
            let [x, y, z] = camera.axes.map(|a| vector(a.as_dvec3()));
            let (x, y, z, tan, _, _) =
                camera_direction_adjoint(x, y, z, camera.tan_half_x_fov, px, py, vector(d_bar));
            sums.camera.origin += o_bar;
            for (sum, bar) in sums.camera.axes.iter_mut().zip([x, y, z]) {
                *sum += dvec3(bar);
            }
            sums.camera.tan_half_x_fov += tan;
        }
    }

    /// Whether a boundary between what two triangles show can move.
    pub fn moves(&self, a: u32, b: u32) -> bool {
        let of = |t: u32| t != NO_TRIANGLE && self.wanted.moves(self.tracer.geometry, t);
        self.wanted.camera || of(a) || of(b)
    }
}

fn finite(v: DVec3) -> Vec3 {
    if v.is_finite() {
        v.as_vec3()
    } else {
        Vec3::ZERO
    }
}
