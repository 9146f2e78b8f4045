//! The tangent sweep over crossings: silhouettes on the film, on lights, over hemispheres.

use super::forward::{ForwardSweep, MovingVertex, dual_lane, dual_number};
use super::motion::dual_vector;
use crate::kernels::camera::camera_direction;
use crate::kernels::frame::direction_from_local;
use crate::kernels::interface::{Interface, RoughTransmission, interface_bounce};
use crate::lanes::{Dual, Real, V3};
use crate::paths::bounce_cells::BounceCrossing;
use crate::paths::store::{FilmCrossing, LightCrossing};
use crate::scene::Rgb;
use glam::Vec3;

impl ForwardSweep<'_> {
    /// Radiance that a moving shadow edge brings (`paths::light_cells`).
    pub(super) fn light_crossing(&self, crossing: &LightCrossing, here: &MovingVertex) -> Rgb {
        let x = dual_lane(here.x, crossing.lane as usize);
        let (ids, b) = self.tracer.lights.patches[crossing.patch as usize]
            .vertices_at(crossing.at[0] as f32, crossing.at[1] as f32);
        let [q0, q1, q2] = ids.map(|v| self.motion.point(self.tracer.geometry, v));
        let [b1, b2] = b.map(|b| Dual::<f64>::splat(b as f64));
        let y = q0 + (q1 - q0) * b1 + (q2 - q0) * b2;
        let side = crossing
            .boundary
            .side(x, y - x, |v| self.motion.point(self.tracer.geometry, v));
        crossing
            .radiance_per_side
            .map(|w| (w as f64 * side.tangent) as f32)
    }

    /// Radiance that a silhouette brings that moves over the hemisphere (`paths::bounce_cells`).
    pub(super) fn bounce_crossing(&self, crossing: &BounceCrossing, here: &MovingVertex) -> Rgb {
        let lane = crossing.lane as usize;
        let x = dual_lane(here.x, lane);
        let d = if crossing.in_sky {
            let d = Vec3::from(crossing.local.map(|x| x as f32));
            let turning = self.motion.environment.rotation.cross(d);
            dual_vector(
                V3::new(crossing.local[0], crossing.local[1], crossing.local[2]),
                V3::new(turning.x as f64, turning.y as f64, turning.z as f64),
            )
        } else {
            self.direction_at(here, lane, crossing.local)
        };
        let side = crossing
            .boundary
            .side(x, d, |v| self.motion.point(self.tracer.geometry, v));
        crossing
            .radiance_per_side
            .map(|w| (w as f64 * side.tangent) as f32)
    }

    /// The direction of a lane's lobe at a fixed coordinate.
    fn direction_at(&self, here: &MovingVertex, lane: usize, local: [f64; 3]) -> V3<Dual<f64>> {
        let n = dual_lane(here.n, lane);
        let [lx, ly, lz] = local.map(Dual::<f64>::splat);
        let vertices = here.vertices;
        let bit = |bits: u32| bits >> lane & 1 == 1;
        let lobes = &vertices.lobes;
        let Some(s) = &here.interface else {
            return direction_from_local(n, lx, ly, lz);
        };
        if bit(lobes.diffuse) {
            return direction_from_local(n, lx, ly, lz);
        }
        let interface = Interface {
            colour: dual_lane(s.colour, lane),
            second: dual_lane(s.second, lane),
            eta: dual_lane(s.eta, lane),
            k: dual_lane(s.k, lane),
            alpha: dual_number(s.alpha, lane),
        };
        let kinds = &vertices.kinds;
        let (direction, _) = interface_bounce(
            n,
            dual_lane(here.direction, lane),
            lx,
            ly,
            lz,
            interface,
            RoughTransmission::none(),
            false,
            bit(lobes.reflected),
            bit(lobes.refracted),
            bit(kinds.conductor),
            bit(kinds.plastic),
            bit(kinds.smooth),
            bit(kinds.ggx),
            bit(kinds.nonlinear),
            !bit(kinds.inside),
        );
        direction
    }

    /// What a film crossing adds where it is: jump times speed, per pixel of lattice line.
    pub fn film_crossing(&self, crossing: &FilmCrossing) -> Rgb {
        let camera = &self.camera_f64;
        let [u, v] = crossing.at.map(Dual::<f64>::splat);
        let (px, py) = self.tracer.camera.film_to_camera(u, v);
        let [x, y, z] = camera.axes;
        let d = camera_direction(x, y, z, camera.tan_half_x_fov, px, py);
        let side = crossing.boundary.side(camera.origin, d, |v| {
            self.motion.point(self.tracer.geometry, v)
        });
        match crossing.velocity_per_side(self.tracer) {
            Some(velocity) => crossing
                .jump
                .map(|j| (j as f64 * velocity * side.tangent) as f32),
            None => [0.0; 3],
        }
    }
}
