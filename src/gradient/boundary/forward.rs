//! The forward sweep over boundary samples: what moving boundaries bring.

use crate::discontinuity::boundary::vector;
use crate::gradient::path::forward::{ForwardSweep, MovingVertex, dual_lane, dual_number};
use crate::gradient::scene::forward::dual_vector;
use crate::kernels::bsdf::{Interface, RoughTransmission, bsdf_sample};
use crate::kernels::frame::direction_from_local;
use crate::kernels::silhouette::edge_side;
use crate::kernels::triangle::triangle_point;
use crate::lanes::{Dual, Lane, Real, V3};
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, Shadow};
use crate::paths::chain::{ChainScene, through};
use crate::paths::film::drift::Followed;
use crate::paths::rays::splat;
use crate::paths::store::TileStore;
use crate::paths::surface::relief::Turned;
use crate::scene::{DeltaLightKind, Relief, Rgb};
use glam::Vec3;

type D = Dual<f64>;

impl ChainScene<D> for ForwardSweep<'_> {
    fn point(&self, vertex: u32) -> V3<D> {
        self.motion.point(self.view.geometry, vertex)
    }

    fn normal(&self, vertex: u32) -> V3<D> {
        self.motion.normal(self.view.geometry, vertex)
    }

    fn eta(&self, texture: usize) -> D {
        D {
            value: f64::from(self.view.scene.constant(texture)[0]),
            tangent: f64::from(self.motion.texel(texture)[0]),
        }
    }

    fn relief_change(&self, relief: &Relief, turned: &Turned) -> Vec3 {
        self.motion.relief(relief, turned)
    }
}

impl ForwardSweep<'_> {
    /// What a boundary sample of a vertex brings: its weight times Ḟ.
    pub(crate) fn boundary(
        &self,
        found: &Found,
        sample: &BoundarySample,
        here: &MovingVertex,
    ) -> Rgb {
        let lane = sample.lane as usize;
        let x = dual_lane(here.x, lane);
        let direction = match sample.at {
            Coordinate::Light { patch, at } => self.light_point(patch, at) - x,
            Coordinate::Environment(d) => {
                let along = Vec3::from(d.map(|x| x as f32));
                let turning = self.motion.environment.rotation.cross(along);
                let [x, y, z] = d;
                dual_vector(
                    V3::new(x, y, z),
                    V3::new(turning.x as f64, turning.y as f64, turning.z as f64),
                )
            }
            Coordinate::Lobe(local) => {
                let direction = self.direction_at(here, lane, local);
                let direction = self.at_rest(here, lane, direction);
                self.carried(here, lane, direction)
            }
            Coordinate::Film { .. } => return [0.0; 3],
        };
        self.weighed(found, sample, (x, direction))
    }

    /// Tells what each boundary sample along the paths of packet `packet` brings, whose camera rays
    /// go through film points which may move.
    pub fn borders(
        &self,
        store: &TileStore,
        packet: usize,
        at: [Dual<Lane>; 2],
        mut each: impl FnMut(&BoundarySample, Rgb),
    ) {
        self.path_derivative(store, packet, at, &[], &mut each);
    }

    /// What a boundary sample of the film adds where it is, in radiance times pixels, if the film
    /// drifts there with this velocity; at a point of its piece.
    pub fn film_boundary(
        &self,
        found: &Found,
        sample: &BoundarySample,
        at: [f64; 2],
        drift: [f64; 2],
    ) -> Rgb {
        self.weighed(found, sample, self.moving_camera_ray(at, drift))
    }

    /// The camera's ray through a film point with this velocity.
    fn moving_camera_ray(&self, at: [f64; 2], velocity: [f64; 2]) -> (V3<D>, V3<D>) {
        let [u, v] = [0, 1].map(|i| D {
            value: at[i],
            tangent: velocity[i],
        });
        let (px, py) = self.view.camera.film_to_camera(u, v);
        self.camera_f64.ray([px, py])
    }

    /// How fast a point that the film follows moves over it.
    pub fn film_velocity(&self, followed: &Followed) -> [f64; 2] {
        let point = |v| self.motion.point(self.view.geometry, v);
        let [p, q, r] = followed.triangle.map(point);
        let [b0, b1, b2] = followed.barycentrics.map(D::splat);
        let y = p * b0 + q * b1 + r * b2;
        let (origin, d) = self.moving_camera_ray(followed.at, [0.0; 2]);
        // The line through it along the other axis of the film crosses that film point.
        let camera = &self.view.camera;
        followed.lines(camera, self.view.geometry).map(|line| {
            let along = dual_vector(vector(line.along), V3::splat(0.0));
            line.velocity_per_side * edge_side(origin, d, y, y + along).tangent
        })
    }

    /// The weight times Ḟ, seen along a ray.
    fn weighed(&self, found: &Found, sample: &BoundarySample, ray: (V3<D>, V3<D>)) -> Rgb {
        let view = self.view;
        let point = |v| self.motion.point(view.geometry, v);
        let (x, direction) = through(view, found.chain(sample), ray, self);
        let (x, direction) = match &sample.shadow {
            Some(shadow) => self.toward_delta_light(shadow, x, direction),
            None => (x, direction),
        };
        let side = sample.boundary.side(x, direction, point);
        sample.weight.map(|w| (w as f64 * side.tangent) as f32)
    }

    /// From where a ray meets the receiver of a shadow, toward the light.
    fn toward_delta_light(
        &self,
        &Shadow { light, receiver }: &Shadow,
        x: V3<D>,
        direction: V3<D>,
    ) -> (V3<D>, V3<D>) {
        let geometry = self.view.geometry;
        let corners = geometry.triangles[receiver as usize];
        let [p, q, r] = corners.map(|v| self.motion.point(geometry, v));
        let y = triangle_point(x, direction, p, q, r);
        let light = light as usize;
        let toward = match self.view.delta_lights[light].kind {
            DeltaLightKind::Point { position } => {
                dual_vector(splat(position), splat(self.motion.delta_lights[light])) - y
            }
            DeltaLightKind::Directional { direction } => {
                dual_vector(splat(-direction), V3::splat(0.0))
            }
        };
        (y, toward)
    }

    /// A point of a light's patch.
    fn light_point(&self, patch: u32, at: [f64; 2]) -> V3<D> {
        let [s, r] = at.map(|x| x as f32);
        let (ids, b) = self.view.lights.patches[patch as usize].vertices_at(s, r);
        let [q0, q1, q2] = ids.map(|v| self.motion.point(self.view.geometry, v));
        let [b1, b2] = b.map(|b| D::splat(b as f64));
        q0 + (q1 - q0) * b1 + (q2 - q0) * b2
    }

    /// The direction of a lane's lobe at a fixed coordinate.
    fn direction_at(&self, here: &MovingVertex, lane: usize, local: [f64; 3]) -> V3<D> {
        let n = dual_lane(here.n, lane);
        let [x, y, z] = local.map(D::splat);
        let local = V3::new(x, y, z);
        let vertices = here.vertices;
        let Some(s) = &here.interface else {
            return direction_from_local(n, local);
        };
        if vertices.lobes.diffuse >> lane & 1 == 1 {
            return direction_from_local(n, local);
        }
        let interface = Interface {
            reflectance: dual_lane(s.reflectance, lane),
            second_reflectance: dual_lane(s.second_reflectance, lane),
            eta: dual_lane(s.eta, lane),
            k: dual_lane(s.k, lane),
            alpha: dual_number(s.alpha, lane),
        };
        let (direction, _) = bsdf_sample(
            n,
            dual_lane(here.direction, lane),
            local,
            interface,
            RoughTransmission::none(),
            vertices.lobes.masks_of_lane(lane),
            vertices.kinds.masks_of_lane(lane),
        );
        direction
    }
}
