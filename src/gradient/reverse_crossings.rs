//! The adjoint sweep over crossings: silhouettes on the film, on lights, over hemispheres.

use super::accumulator::TileSums;
use super::forward::range;
use super::reverse::{ReverseSweep, Solved, VertexBars};
use crate::adjoint::camera::camera_direction_adjoint;
use crate::adjoint::frame::direction_from_local_adjoint;
use crate::adjoint::interface::interface_bounce_adjoint;
use crate::kernels::frame::direction_from_local;
use crate::kernels::interface::{RoughTransmission, interface_bounce};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::bounce_cells::BounceCrossing;
use crate::paths::bounce_lines::interface_of_lane;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::store::{FilmCrossing, LightCrossing, TileStore};
use crate::scene::Rgb;
use crate::warp::boundary::{dvec3, vector};
use glam::{DVec3, Vec3};

/// Cotangents of one lane of a vertex.
#[derive(Clone, Copy, Default)]
struct LaneBars {
    x: Vec3,
    n: Vec3,
    direction: Vec3,
    eta: f32,
}

impl ReverseSweep<'_> {
    /// Shadow edges and silhouettes over the hemisphere.
    pub(super) fn crossings(
        &self,
        store: &TileStore,
        here: &Solved,
        radiance_bar: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let vertices = here.vertices;
        let lights = &store.light_crossings[range(vertices.crossings)];
        let bounces = &store.bounce_crossings[range(vertices.bounce_crossings)];
        if lights.is_empty() && bounces.is_empty() {
            return;
        }
        let mut lanes = [LaneBars::default(); LANES];
        for crossing in lights {
            let lane = crossing.lane as usize;
            lanes[lane].x += self.light_crossing(crossing, here, lane_of(radiance_bar, lane), sums);
        }
        for crossing in bounces {
            let lane = crossing.lane as usize;
            let bar = lane_of(radiance_bar, lane);
            let added = self.bounce_crossing(crossing, here, bar, sums);
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

    fn light_crossing(
        &self,
        crossing: &LightCrossing,
        here: &Solved,
        bar: Vec3,
        sums: &mut TileSums,
    ) -> Vec3 {
        let lane = crossing.lane as usize;
        let side_bar = side_bar(bar, crossing.radiance_per_side);
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
        sums.admitted(o_bar - d_bar).as_vec3()
    }

    fn bounce_crossing(
        &self,
        crossing: &BounceCrossing,
        here: &Solved,
        bar: Vec3,
        sums: &mut TileSums,
    ) -> LaneBars {
        let lane = crossing.lane as usize;
        let side_bar = side_bar(bar, crossing.radiance_per_side);
        let (x, n) = (
            lane_of(here.x, lane).as_dvec3(),
            vector(lane_of(here.n, lane).as_dvec3()),
        );
        let [lx, ly, lz] = crossing.local;
        let vertices = here.vertices;
        let bit = |bits: u32| bits >> lane & 1 == 1;
        let side = |d: DVec3, sums: &mut TileSums| {
            crossing
                .boundary
                .side_adjoint(self.tracer.geometry, x, d, side_bar, |v, bar| {
                    self.scatter_vertex(v, bar, sums)
                })
        };
        if crossing.in_sky {
            let d = DVec3::from(crossing.local);
            let (o_bar, d_bar) = side(d, sums);
            // The direction turns with the map by ω × d.
            let turn = d.cross(d_bar);
            if self.wanted.environment {
                let turn = sums.admitted(turn);
                sums.add_environment(turn, 0.0);
            }
            return LaneBars {
                x: sums.admitted(o_bar).as_vec3(),
                ..LaneBars::default()
            };
        }
        let interface = match &here.interface {
            Some(s) if !bit(vertices.lobes.diffuse) => interface_of_lane(s, lane),
            _ => {
                let d = dvec3(direction_from_local(n, lx, ly, lz));
                let (o_bar, d_bar) = side(d, sums);
                let (n_bar, _, _, _) = direction_from_local_adjoint(n, lx, ly, lz, vector(d_bar));
                return LaneBars {
                    x: sums.admitted(o_bar).as_vec3(),
                    n: sums.admitted(dvec3(n_bar)).as_vec3(),
                    ..LaneBars::default()
                };
            }
        };
        let arriving = vector(lane_of(vertices.direction, lane).as_dvec3());
        let none = RoughTransmission::none();
        let kinds = &vertices.kinds;
        let (reflected, refracted) = (bit(vertices.lobes.reflected), bit(vertices.lobes.refracted));
        let (conductor, plastic) = (bit(kinds.conductor), bit(kinds.plastic));
        let (smooth, ggx) = (bit(kinds.smooth), bit(kinds.ggx));
        let (nonlinear, entering) = (bit(kinds.nonlinear), !bit(kinds.inside));
        let (d, _) = interface_bounce(
            n, arriving, lx, ly, lz, interface, none, false, reflected, refracted, conductor,
            plastic, smooth, ggx, nonlinear, entering,
        );
        let (o_bar, d_bar) = side(dvec3(d), sums);
        let no_weight = V3::splat(0.0);
        let (n_bar, direction_bar, _, _, _, s_bar, _) = interface_bounce_adjoint(
            n,
            arriving,
            lx,
            ly,
            lz,
            interface,
            none,
            false,
            reflected,
            refracted,
            conductor,
            plastic,
            smooth,
            ggx,
            nonlinear,
            entering,
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
        if self.wanted.camera && sums.admits(o_bar.is_finite() && d_bar.is_finite()) {
            let (px, py) = camera.film_to_camera(u, v);
            let [x, y, z] = camera.axes.map(|a| vector(a.as_dvec3()));
            let (x, y, z, tan, _, _) =
                camera_direction_adjoint(x, y, z, camera.tan_half_x_fov, px, py, vector(d_bar));
            sums.add_camera(o_bar, [x, y, z].map(dvec3), tan);
        }
    }
}

fn side_bar(bar: Vec3, radiance_per_side: Rgb) -> f64 {
    bar.as_dvec3().dot(Vec3::from(radiance_per_side).as_dvec3())
}
