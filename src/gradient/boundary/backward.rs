//! The backward sweep over boundary samples: from what moving boundaries bring to everything that
//! moves them.

use crate::adjoint::bsdf::bsdf_sample_adjoint;
use crate::adjoint::frame::direction_from_local_adjoint;
use crate::adjoint::silhouette::edge_side_adjoint;
use crate::adjoint::triangle::triangle_point_adjoint;
use crate::discontinuity::boundary::{dvec3, vector};
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::VertexBars;
use crate::gradient::scene::backward::TileSums;
use crate::gradient::scene::camera_ray::camera_ray_adjoint;
use crate::kernels::bsdf::{RoughTransmission, bsdf_sample};
use crate::kernels::frame::direction_from_local;
use crate::kernels::triangle::triangle_point;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, Shadow};
use crate::paths::chain_vertex::ChainVertex;
use crate::paths::film::drift::Followed;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::store::TileStore;
use crate::paths::surface::interface::interface_of_lane;
use crate::scene::{DeltaLightKind, Rgb};
use glam::{DVec3, Vec3};

/// Cotangents of one lane of a vertex.
#[derive(Clone, Copy, Default)]
struct LaneBars {
    x: Vec3,
    n: Vec3,
    direction: Vec3,
    eta: f32,
}

/// A boundary sample, the chain through which it is seen, and the cotangent of its F.
pub(crate) struct Seen<'a> {
    sample: &'a BoundarySample,
    chain: &'a [ChainVertex],
    bar: f64,
}

impl BackwardSweep<'_> {
    /// The boundary samples of a vertex.
    pub(crate) fn boundary(
        &self,
        store: &TileStore,
        here: &Solved,
        radiance_bar: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let samples = store.boundary(here.vertices);
        if samples.is_empty() {
            return;
        }
        let mut lanes = [LaneBars::default(); LANES];
        for sample in samples {
            let lane = sample.lane as usize;
            let bar = side_bar(lane_of(radiance_bar, lane), sample);
            let seen = Seen {
                sample,
                chain: store.found.chain(sample),
                bar,
            };
            let added = match sample.at {
                Coordinate::Light { patch, at } => self.on_light(&seen, here, (patch, at), sums),
                Coordinate::Environment(d) => self.on_environment(&seen, here, d.into(), sums),
                Coordinate::Lobe(local) => self.on_lobe(&seen, here, local, sums),
                Coordinate::Film { .. } => LaneBars::default(),
            };
            let sum = &mut lanes[lane];
            sum.x += added.x;
            sum.n += added.n;
            sum.direction += added.direction;
            sum.eta += added.eta;
        }
        bars.x = bars.x + from_lanes(&lanes.map(|l| l.x));
        bars.n = bars.n + from_lanes(&lanes.map(|l| l.n));
        bars.direction = bars.direction + from_lanes(&lanes.map(|l| l.direction));
        bars.interface.eta.x += Lane::new(lanes.map(|l| l.eta));
    }

    /// Cotangents of origin and direction from that of F; those of vertices, of what the chain
    /// meets, too, are added.
    fn side(&self, seen: &Seen, x: DVec3, d: DVec3, sums: &mut TileSums) -> (DVec3, DVec3) {
        let rays = self.along(seen.chain, (x, d));
        let (x, d) = rays[seen.chain.len()];
        let mut bars = self.side_at_end(seen.sample, x, d, seen.bar, sums);
        for (vertex, &ray) in seen.chain.iter().zip(&rays).rev() {
            bars = self.back_through(vertex, ray, bars, sums);
        }
        bars
    }

    /// The same of the ray at the chain's end; those of delta lights are added, too.
    fn side_at_end(
        &self,
        sample: &BoundarySample,
        x: DVec3,
        d: DVec3,
        bar: f64,
        sums: &mut TileSums,
    ) -> (DVec3, DVec3) {
        let Some(Shadow { light, receiver }) = sample.shadow else {
            return self.side_seen(sample, x, d, bar, sums);
        };
        let (geometry, light) = (self.view.geometry, light as usize);
        let corners = geometry.triangles[receiver as usize];
        let [p, q, r] = corners.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
        let y = dvec3(triangle_point(vector(x), vector(d), p, q, r));
        let y_bar = match self.view.delta_lights[light].kind {
            DeltaLightKind::Point { position } => {
                let toward = position.as_dvec3() - y;
                let (y_bar, light_bar) = self.side_seen(sample, y, toward, bar, sums);
                let light_bar = sums.admitted(light_bar);
                sums.delta_lights[light] += light_bar;
                y_bar - light_bar
            }
            DeltaLightKind::Directional { direction } => {
                let toward = -direction.as_dvec3();
                self.side_seen(sample, y, toward, bar, sums).0
            }
        };
        let (x_bar, d_bar, p_bar, q_bar, r_bar) =
            triangle_point_adjoint(vector(x), vector(d), p, q, r, vector(y_bar));
        for (v, bar) in corners.into_iter().zip([p_bar, q_bar, r_bar]) {
            self.scatter_vertex(v, dvec3(bar), sums);
        }
        (dvec3(x_bar), dvec3(d_bar))
    }

    /// The same of the direction in which the boundary is seen.
    fn side_seen(
        &self,
        sample: &BoundarySample,
        x: DVec3,
        d: DVec3,
        bar: f64,
        sums: &mut TileSums,
    ) -> (DVec3, DVec3) {
        let integral = sample.at.integral();
        let scatter = |v, bar: DVec3| {
            if bar.is_finite() {
                sums.brought[integral] += bar.length();
            }
            self.scatter_vertex(v, bar, sums);
        };
        let geometry = self.view.geometry;
        sample.boundary.side_adjoint(geometry, x, d, bar, scatter)
    }

    fn on_light(
        &self,
        seen: &Seen,
        here: &Solved,
        (patch, at): (u32, [f64; 2]),
        sums: &mut TileSums,
    ) -> LaneBars {
        let x = lane_of(here.x, seen.sample.lane as usize).as_dvec3();
        let geometry = self.view.geometry;
        let [s, r] = at.map(|x| x as f32);
        let (ids, [b1, b2]) = self.view.lights.patches[patch as usize].vertices_at(s, r);
        let b = [1.0 - b1 as f64 - b2 as f64, b1 as f64, b2 as f64];
        let y: DVec3 = ids
            .iter()
            .zip(b)
            .map(|(&v, b)| geometry.positions[v as usize].as_dvec3() * b)
            .sum();
        let (o_bar, d_bar) = self.side(seen, x, y - x, sums);
        for (&v, b) in ids.iter().zip(b) {
            self.scatter_vertex(v, d_bar * b, sums);
        }
        LaneBars {
            x: sums.admitted(o_bar - d_bar).as_vec3(),
            ..LaneBars::default()
        }
    }

    fn on_environment(
        &self,
        seen: &Seen,
        here: &Solved,
        d: DVec3,
        sums: &mut TileSums,
    ) -> LaneBars {
        let x = lane_of(here.x, seen.sample.lane as usize).as_dvec3();
        let (o_bar, d_bar) = self.side(seen, x, d, sums);
        // The direction turns with the map by ω × d.
        let turn = d.cross(d_bar);
        if self.wanted.environment {
            let turn = sums.admitted(turn);
            sums.add_environment(turn, 0.0);
        }
        LaneBars {
            x: sums.admitted(o_bar).as_vec3(),
            ..LaneBars::default()
        }
    }

    fn on_lobe(
        &self,
        seen: &Seen,
        here: &Solved,
        local: [f64; 3],
        sums: &mut TileSums,
    ) -> LaneBars {
        let lane = seen.sample.lane as usize;
        let x = lane_of(here.x, lane).as_dvec3();
        let n = vector(lane_of(here.n, lane).as_dvec3());
        let local = vector(local.into());
        let vertices = here.vertices;
        let interface = match &here.interface {
            Some(s) if vertices.lobes.diffuse >> lane & 1 == 0 => interface_of_lane(s, lane),
            _ => {
                let d = dvec3(direction_from_local(n, local));
                let (o_bar, d_bar) = self.side(seen, x, d, sums);
                let drift = self.carried(here, lane, d, (d_bar, 0.0), sums);
                let (o_bar, d_bar) = (o_bar + drift.x, d_bar + drift.turning);
                let (n_bar, _) = direction_from_local_adjoint(n, local, vector(d_bar));
                return LaneBars {
                    x: sums.admitted(o_bar).as_vec3(),
                    n: sums.admitted(dvec3(n_bar)).as_vec3(),
                    ..LaneBars::default()
                };
            }
        };
        let arriving = vector(lane_of(vertices.direction, lane).as_dvec3());
        let none = RoughTransmission::none();
        let (lobes, kinds) = (
            vertices.lobes.masks_of_lane(lane),
            vertices.kinds.masks_of_lane(lane),
        );
        let (d, _) = bsdf_sample(n, arriving, local, interface, none, lobes, kinds);
        let (o_bar, d_bar) = self.side(seen, x, dvec3(d), sums);
        if vertices.resting_lobes() >> lane & 1 == 1 {
            return LaneBars {
                x: sums.admitted(o_bar).as_vec3(),
                ..LaneBars::default()
            };
        }
        let no_weight = V3::splat(0.0);
        let (n_bar, direction_bar, _, s_bar, _) = bsdf_sample_adjoint(
            n,
            arriving,
            local,
            interface,
            none,
            lobes,
            kinds,
            (vector(d_bar), no_weight),
        );
        let eta = DVec3::new(s_bar.eta.x, 0.0, 0.0);
        LaneBars {
            x: sums.admitted(o_bar).as_vec3(),
            n: sums.admitted(dvec3(n_bar)).as_vec3(),
            direction: sums.admitted(dvec3(direction_bar)).as_vec3(),
            eta: sums.admitted(eta).x as f32,
        }
    }

    /// A boundary sample of the film at a point of its piece, with the cotangent of what it adds
    /// there.
    pub fn add_film_boundary(
        &self,
        found: &Found,
        (sample, [u, v]): (&BoundarySample, [f64; 2]),
        bar: Rgb,
        sums: &mut TileSums,
    ) {
        let camera = &self.view.camera;
        let seen = Seen {
            sample,
            chain: found.chain(sample),
            bar: side_bar(bar.into(), sample),
        };
        let (origin, d) = camera.ray(u, v);
        let (o_bar, d_bar) = self.side(&seen, dvec3(origin), dvec3(d), sums);
        let film_bar = self.camera_ray([u, v], o_bar, d_bar, sums);
        if let Some(drift) = self.drift {
            sums.add_drift(drift, [u, v], film_bar, 0.0);
        }
    }

    /// To the camera, from the cotangents of its ray through a film point. Returns that of the film
    /// point.
    fn camera_ray(
        &self,
        [u, v]: [f64; 2],
        o_bar: DVec3,
        d_bar: DVec3,
        sums: &mut TileSums,
    ) -> [f64; 2] {
        if !sums.admits(o_bar.is_finite() && d_bar.is_finite()) {
            return [0.0; 2];
        }
        let camera = &self.view.camera;
        let bars = camera_ray_adjoint(camera, [u, v], vector(o_bar), vector(d_bar));
        if self.wanted.camera {
            let axes = bars.film_axes.map(dvec3);
            sums.add_camera(camera, o_bar, axes, bars.tan_half_x_fov);
        }
        bars.film
    }

    /// What the film follows, from the cotangent of its velocity in pixels.
    pub fn add_followed(&self, followed: &Followed, velocity_bar: [f64; 2], sums: &mut TileSums) {
        let camera = &self.view.camera;
        let [u, v] = followed.at;
        let (origin, d) = camera.ray(u, v);
        let y = followed.point(self.view.geometry);
        let lines = followed.lines(camera, self.view.geometry);
        for (line, bar) in lines.into_iter().zip(velocity_bar) {
            let side_bar = line.velocity_per_side * bar;
            let (o_bar, d_bar, near_bar, far_bar) =
                edge_side_adjoint(origin, d, vector(y), vector(y + line.along), side_bar);
            let y_bar = dvec3(near_bar) + dvec3(far_bar);
            for (&vertex, b) in followed.triangle.iter().zip(followed.barycentrics) {
                self.scatter_vertex(vertex, y_bar * b, sums);
            }
            self.camera_ray([u, v], dvec3(o_bar), dvec3(d_bar), sums);
        }
    }
}

/// The cotangent of F from that of what the sample brings.
fn side_bar(bar: Vec3, sample: &BoundarySample) -> f64 {
    bar.as_dvec3().dot(Vec3::from(sample.weight).as_dvec3())
}
