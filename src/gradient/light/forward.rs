//! The forward sweep over light: emission that rays found, light samples, the environment.

use crate::gradient::path::forward::{Arriving, ForwardSweep, MovingVertex, constant, value_of};
use crate::gradient::scene::forward::{dual_vector, tangent_of};
use crate::kernels::light::{direction_irradiance, triangle_irradiance};
use crate::lanes::{Lane, Mask, Real, V3};
use crate::paths::rays::{from_lanes, lane_mask, splat};
use crate::paths::store::Vertices;
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::kinds::LightKind;
use crate::scene::Rgb;
use glam::Vec3;

impl ForwardSweep<'_> {
    pub(crate) fn escape(
        &self,
        vertices: &Vertices,
        chain: &Arriving,
        previous: Option<&MovingVertex>,
    ) -> V3<Lane> {
        let Some(environment) = &self.view.scene.environment else {
            return V3::splat(0.0);
        };
        let direction = value_of(chain.direction);
        let value = self.view.environment_radiance(environment, direction);
        let tangent = self.motion.environment_change(
            self.view.scene,
            environment,
            direction,
            tangent_of(chain.direction),
        );
        let seen = tangent_of(chain.throughput.times(dual_vector(value, tangent)));
        let sampled = vertices.sampled & vertices.escaped;
        let (Some(from), true) = (previous, sampled != 0) else {
            return seen;
        };
        let weight = vertices.emission_weight;
        let brings = self.environment_brings(from, vertices.direction, weight);
        V3::select(lane_mask(sampled), brings, seen)
    }

    /// What the environment map brings to a vertex from `direction`, which keeps its place on the
    /// map.
    pub(crate) fn environment_brings(
        &self,
        here: &MovingVertex,
        direction: V3<Lane>,
        weight: Lane,
    ) -> V3<Lane> {
        let turning = splat::<Lane>(self.motion.environment.rotation).cross(direction);
        self.turning_environment(here, direction, weight, turning)
    }

    /// The same from a direction that changes by `turning`.
    pub(crate) fn turning_environment(
        &self,
        here: &MovingVertex,
        direction: V3<Lane>,
        weight: Lane,
        turning: V3<Lane>,
    ) -> V3<Lane> {
        let Some(environment) = &self.view.scene.environment else {
            return V3::splat(0.0);
        };
        let w = dual_vector(direction, turning);
        let value = self.view.environment_radiance(environment, direction);
        let scene = self.view.scene;
        let brighter = self
            .motion
            .environment_change(scene, environment, direction, turning);
        let irradiance = direction_irradiance(here.n, w) * constant(weight);
        let arrives = self
            .bsdf_evaluate(here, w, LightKind::Sampled)
            .times(dual_vector(value, brighter))
            * irradiance;
        tangent_of(here.throughput.times(arrives))
    }

    /// Emission that the arriving ray found. In lanes that share the lights with light samples it
    /// is a sample of the integral over the light's surface (`paths::light::sample`): its point
    /// keeps its barycentrics, and the irradiance kernel moves. In others it is seen as by the
    /// camera.
    pub(crate) fn emission(
        &self,
        chain: &Arriving,
        here: &MovingVertex,
        previous: Option<&MovingVertex>,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let value = self.view.emission(vertices);
        let zero = Lane::splat(0.0);
        let emits = vertices.emission_weight.gt(zero)
            & (value.x.max(value.y).max(value.z).gt(zero) | lane_mask(self.changing(vertices)));
        if !emits.any() {
            return V3::splat(0.0);
        }
        let weight = constant(vertices.emission_weight);
        let seen = self.emission_tangent(vertices, here.b.map(|b| b.tangent));
        let mut sum = tangent_of(chain.throughput.times(dual_vector(value, seen)) * weight);
        if let (Some(from), true) = (previous, vertices.sampled != 0) {
            let [q0, q1, q2] = here.corners;
            let b = here.b.map(|b| constant(b.value));
            let irradiance = triangle_irradiance(from.x, from.n, [q0, q1, q2], b[0], b[1]);
            let y = q0 + (q1 - q0) * b[0] + (q2 - q0) * b[1];
            let radiance = dual_vector(value, self.emission_tangent(vertices, [zero; 2]));
            let arrives = self.bsdf_evaluate(from, y - from.x, LightKind::Sampled) * irradiance;
            let all = from.throughput.times(arrives).times(radiance) * weight;
            sum = V3::select(lane_mask(vertices.sampled), tangent_of(all), sum);
        }
        V3::select(emits, sum, V3::splat(0.0))
    }

    /// Lanes on lights whose radiance changes, so that black ones count too.
    fn changing(&self, vertices: &Vertices) -> u32 {
        if !self.motion.colours {
            return 0;
        }
        let tangent = self.emission_tangent(vertices, [Lane::splat(0.0); 2]);
        let t = tangent;
        let size = t.x.abs() + t.y.abs() + t.z.abs();
        size.gt(Lane::splat(0.0)).to_bits()
    }

    /// The change of the radiance emitted where the rays end, if the barycentrics change by `db`.
    fn emission_tangent(&self, vertices: &Vertices, db: [Lane; 2]) -> V3<Lane> {
        let view = self.view;
        if !self.motion.colours && !view.lights.any_texture {
            return V3::splat(0.0);
        }
        let b = view.barycentrics(vertices).map(Lane::to_array);
        let db = db.map(Lane::to_array);
        view.per_lane(&vertices.triangle, |mesh, lane| {
            match view.lights.of_mesh[mesh] {
                Some(light) if view.sees_front(vertices, lane) => {
                    let at = [b[0][lane], b[1][lane]];
                    let moved = [db[0][lane], db[1][lane]];
                    self.light_tangent(light as usize, vertices.triangle[lane], at, moved)
                }
                _ => [0.0; 3],
            }
        })
    }

    pub(crate) fn light_tangent(
        &self,
        light: usize,
        triangle: u32,
        b: [f32; 2],
        db: [f32; 2],
    ) -> Rgb {
        let scene = self.view.scene;
        let texture = scene.area_lights[light].radiance;
        let (found, by_b) = texture_at(scene, self.view.geometry, texture, triangle, b);
        (self.motion.texture(texture, &found) + by_b[0] * db[0] + by_b[1] * db[1]).to_array()
    }

    pub(crate) fn light_sample(&self, here: &MovingVertex) -> V3<Lane> {
        let view = self.view;
        let light = &here.vertices.light;
        let lit = light.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return V3::splat(0.0);
        }
        let (ids, b) = view.patch_corners(&light.patch, &light.s.to_array(), &light.r.to_array());
        let [q0, q1, q2] = self.motion.corners(view.geometry, &ids);
        let b = b.map(constant);
        let irradiance = triangle_irradiance(here.x, here.n, [q0, q1, q2], b[0], b[1]);
        let y = q0 + (q1 - q0) * b[0] + (q2 - q0) * b[1];
        let tangent = if self.motion.colours {
            let (s, r) = (light.s.to_array(), light.r.to_array());
            from_lanes(&std::array::from_fn(|l| {
                let patch = &view.lights.patches[light.patch[l] as usize];
                let (triangle, b) = patch.triangle_at(s[l], r[l]);
                Vec3::from(self.light_tangent(patch.light as usize, triangle, b, [0.0; 2]))
            }))
        } else {
            V3::splat(0.0)
        };
        let radiance = dual_vector(view.light_radiance(light), tangent);
        let value = self.bsdf_evaluate(here, y - here.x, LightKind::Sampled);
        let arrives = value.times(radiance) * (irradiance * constant(light.weight));
        V3::select(
            lit,
            tangent_of(here.throughput.times(arrives)),
            V3::splat(0.0),
        )
    }
}
