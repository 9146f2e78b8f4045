//! The tangent sweep: from stored vertices, camera side first, to the derivative of each path's radiance.

use super::motion::{Motion, MovingCamera, dual_vector, tangent_of};
use crate::kernels::camera::camera_direction;
use crate::kernels::frame::direction_from_local;
use crate::kernels::interface::{
    Interface, RoughTransmission, consistent_normal, interface_bounce, interface_value,
};
use crate::kernels::light::{direction_irradiance, point_irradiance, triangle_irradiance};
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{Dual, Lane, Mask, Real, V3};
use crate::paths::bounce_cells::BounceCrossing;
use crate::paths::camera::splat;
use crate::paths::materials::texture_at;
use crate::paths::rays::from_lanes;
use crate::paths::store::{FilmCrossing, LightCrossing, TileStore, Vertices, lane_mask, masked};
use crate::paths::tracer::Tracer;
use crate::scene::{DeltaLightKind, Rgb};
use glam::Vec3;

type D = Dual<Lane>;

/// Runs tangent sweeps over a tile's store.
pub struct ForwardSweep<'a> {
    pub tracer: &'a Tracer<'a>,
    pub motion: &'a Motion,
    /// Whether the silhouettes' motion counts; without it this is the derivative that ignores visibility.
    pub visibility: bool,
    camera_lanes: MovingCamera<Lane>,
    camera_f64: MovingCamera<f64>,
}

/// The state that one vertex hands to the next.
struct Chain {
    origin: V3<D>,
    direction: V3<D>,
    throughput: V3<D>,
    /// Whether any lane's ray or throughput moves.
    moves: bool,
}

/// A vertex with everything about it moving.
struct MovingVertex<'a> {
    vertices: &'a Vertices,
    x: V3<D>,
    n: V3<D>,
    corners: [V3<D>; 3],
    b: [D; 2],
    /// The ray that arrived, and the path's weight with it.
    direction: V3<D>,
    throughput: V3<D>,
    colour: V3<D>,
    /// Given if any lane is more than diffuse.
    interface: Option<Interface<D>>,
}

impl<'a> ForwardSweep<'a> {
    pub fn new(tracer: &'a Tracer<'a>, motion: &'a Motion, visibility: bool) -> Self {
        Self {
            tracer,
            motion,
            visibility,
            camera_lanes: motion.camera(&tracer.camera),
            camera_f64: motion.camera(&tracer.camera),
        }
    }

    /// d radiance/dθ of the paths of packet `packet`, whose camera rays go through the film points (`u`, `v`).
    pub fn radiance_tangent(&self, store: &TileStore, packet: usize, u: Lane, v: Lane) -> V3<Lane> {
        let camera = &self.camera_lanes;
        let (px, py) = self.tracer.camera.film_to_camera(constant(u), constant(v));
        let [x, y, z] = camera.axes;
        let mut chain = Chain {
            origin: camera.origin,
            direction: camera_direction(x, y, z, camera.tan_half_x_fov, px, py),
            throughput: V3::splat(1.0),
            moves: self.motion.camera.is_some(),
        };
        let mut sum = V3::splat(0.0);
        let mut previous: Option<MovingVertex> = None;
        for vertices in store.path(packet) {
            let (contribution, here) = self.vertex(store, vertices, &mut chain, previous.as_ref());
            sum = sum + contribution;
            previous = here;
        }
        sum
    }

    /// One vertex's contribution to the tangent; moves the chain on.
    fn vertex<'v>(
        &self,
        store: &TileStore,
        vertices: &'v Vertices,
        chain: &mut Chain,
        previous: Option<&MovingVertex>,
    ) -> (V3<Lane>, Option<MovingVertex<'v>>) {
        let mut sum = V3::splat(0.0);
        if vertices.escaped != 0 {
            sum = masked(vertices.escaped, self.escape(chain));
        }
        if vertices.hit == 0 {
            return (sum, None);
        }
        chain.moves |= self
            .motion
            .moves_any(self.tracer.geometry, &vertices.triangle);
        let here = self.moving_vertex(vertices, chain);
        if !self.tracer.lights.is_empty() {
            sum = sum + masked(vertices.hit, self.emission(chain, &here, previous));
            sum = sum + self.light_sample(&here);
        }
        sum = sum + self.delta_lights(store, &here);
        if self.visibility {
            for crossing in &store.light_crossings[range(vertices.crossings)] {
                sum = add_lane(sum, crossing.lane, self.light_crossing(crossing, &here));
            }
            for crossing in &store.bounce_crossings[range(vertices.bounce_crossings)] {
                sum = add_lane(sum, crossing.lane, self.bounce_crossing(crossing, &here));
            }
        }
        let (direction, weight) = self.bounce(&here);
        chain.origin = here.x;
        chain.direction = direction;
        chain.throughput = chain.throughput.times(weight) * constant(vertices.survival);
        (sum, Some(here))
    }

    fn escape(&self, chain: &Chain) -> V3<Lane> {
        let Some(environment) = &self.tracer.scene.environment else {
            return V3::splat(0.0);
        };
        let direction = value_of(chain.direction);
        let value = self.tracer.environment_radiance(environment, direction);
        let tangent = self.motion.sky_tangent(
            self.tracer.scene,
            environment,
            direction,
            tangent_of(chain.direction),
        );
        tangent_of(chain.throughput.times(dual_vector(value, tangent)))
    }

    /// The ray's end, solved again with everything moving.
    fn moving_vertex<'v>(&self, vertices: &'v Vertices, chain: &Chain) -> MovingVertex<'v> {
        let geometry = self.tracer.geometry;
        let ids = geometry.corners(&vertices.triangle);
        let corners = self.motion.corners(geometry, &ids);
        let [v0, v1, v2] = corners;
        let (t, b1, b2) = triangle_hit(chain.origin, chain.direction, v0, v1, v2);
        let mut n = face_normal(v0, v1, v2);
        let smooth = self.tracer.smooth_lanes(&vertices.triangle);
        if smooth != 0 {
            let [n0, n1, n2] = self.motion.corner_normals(geometry, &ids);
            n = V3::select(lane_mask(smooth), shading_normal(n0, n1, n2, b1, b2), n);
        }
        n = n * constant(vertices.facing);
        let special = vertices.kinds.special();
        if special & smooth != 0 {
            let turned = consistent_normal(n, chain.direction);
            n = V3::select(lane_mask(special & smooth), turned, n);
        }
        let mut here = MovingVertex {
            vertices,
            x: chain.origin + chain.direction * t,
            n,
            corners,
            b: [b1, b2],
            direction: chain.direction,
            throughput: chain.throughput,
            colour: dual_vector(vertices.colour, V3::splat(0.0)),
            interface: None,
        };
        if special != 0 || self.tracer.materials.any_texture || self.motion.colours {
            let interface = self.interface(&here);
            here.colour = interface.colour;
            here.interface = (special != 0).then_some(interface);
        }
        here
    }

    fn interface(&self, here: &MovingVertex) -> Interface<D> {
        let tracer = self.tracer;
        let (triangle, kinds) = (&here.vertices.triangle, &here.vertices.kinds);
        let b = here.b.map(|b| b.value);
        let db = here.b.map(|b| b.tangent);
        let (scene, geometry) = (tracer.scene, tracer.geometry);
        let value = tracer
            .materials
            .interface(scene, geometry, triangle, kinds, b);
        let tangent = tracer.materials.interface_tangent(
            scene,
            geometry,
            triangle,
            kinds,
            b,
            db,
            |t, found| self.motion.texture(t, found),
        );
        Interface {
            colour: dual_vector(value.colour, tangent.colour),
            second: dual_vector(value.second, tangent.second),
            eta: dual_vector(value.eta, tangent.eta),
            k: dual_vector(value.k, tangent.k),
            alpha: Dual {
                value: value.alpha,
                tangent: tangent.alpha,
            },
        }
    }

    /// What a rough plastic lets through toward directions at cosine `cos_out`.
    fn transmission(&self, here: &MovingVertex, cos_out: Lane) -> RoughTransmission<D> {
        let n = value_of(here.n);
        let cos_in = -(here.vertices.direction.normalize().dot(n));
        let t = self.tracer.materials.transmission(
            self.tracer.scene,
            self.tracer.geometry,
            &here.vertices.triangle,
            &here.vertices.kinds,
            cos_in,
            cos_out,
        );
        RoughTransmission {
            at_in: constant(t.at_in),
            by_cos_in: constant(t.by_cos_in),
            by_alpha_in: constant(t.by_alpha_in),
            at_out: constant(t.at_out),
            by_cos_out: constant(t.by_cos_out),
            by_alpha_out: constant(t.by_alpha_out),
            inner: constant(t.inner),
            by_alpha_inner: constant(t.by_alpha_inner),
        }
    }

    /// π times the BSDF for light that arrives along `w`, of what light samples light.
    fn value_toward(&self, here: &MovingVertex, w: V3<D>) -> V3<D> {
        let Some(interface) = &here.interface else {
            return here.colour;
        };
        let cos_out = value_of(here.n).dot(value_of(w).normalize());
        let m = here.vertices.kinds.masks();
        let value = interface_value(
            here.n,
            here.direction,
            w,
            *interface,
            self.transmission(here, cos_out),
            m.conductor,
            m.plastic,
            m.wide,
            m.smooth,
            m.ggx,
            m.nonlinear,
        );
        let lit = lane_mask(here.vertices.kinds.lit_by_samples());
        V3::select(lit, value, V3::splat(0.0))
    }

    /// The next ray's direction, and what the path is multiplied with.
    fn bounce(&self, here: &MovingVertex) -> (V3<D>, V3<D>) {
        let vertices = here.vertices;
        let [lx, ly, lz] = vertices.local.map(constant);
        let Some(interface) = &here.interface else {
            return (direction_from_local(here.n, lx, ly, lz), here.colour);
        };
        let m = vertices.kinds.masks();
        let (direction, weight) = interface_bounce(
            here.n,
            here.direction,
            lx,
            ly,
            lz,
            *interface,
            self.transmission(here, vertices.local[2]),
            lane_mask(vertices.lobes.diffuse),
            lane_mask(vertices.lobes.reflected),
            lane_mask(vertices.lobes.refracted),
            m.conductor,
            m.plastic,
            m.smooth,
            m.ggx,
            m.nonlinear,
            m.entering,
        );
        (direction, weight * constant(vertices.inverse_density))
    }

    /// Emission that the arriving ray found. In lanes that share the lights with light samples it is a sample of the
    /// integral over the light's surface (`paths::direct`): its point keeps its barycentrics, and the irradiance kernel
    /// moves. In others it is seen as by the camera.
    fn emission(
        &self,
        chain: &Chain,
        here: &MovingVertex,
        previous: Option<&MovingVertex>,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let value = self.tracer.emission(vertices);
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
            let irradiance = triangle_irradiance(from.x, from.n, q0, q1, q2, b[0], b[1]);
            let y = q0 + (q1 - q0) * b[0] + (q2 - q0) * b[1];
            let radiance = dual_vector(value, self.emission_tangent(vertices, [zero; 2]));
            let arrives = self.value_toward(from, y - from.x) * irradiance;
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
        let tracer = self.tracer;
        if !self.motion.colours && !tracer.lights.any_texture {
            return V3::splat(0.0);
        }
        let b = tracer.barycentrics(vertices).map(Lane::to_array);
        let db = db.map(Lane::to_array);
        tracer.per_lane(&vertices.triangle, |mesh, lane| {
            match tracer.lights.of_mesh[mesh] {
                Some(light) if tracer.sees_front(vertices, lane) => {
                    let at = [b[0][lane], b[1][lane]];
                    let moved = [db[0][lane], db[1][lane]];
                    self.light_tangent(light as usize, vertices.triangle[lane], at, moved)
                }
                _ => [0.0; 3],
            }
        })
    }

    fn light_tangent(&self, light: usize, triangle: u32, b: [f32; 2], db: [f32; 2]) -> Rgb {
        let scene = self.tracer.scene;
        let texture = scene.area_lights[light].radiance;
        let (found, by_b) = texture_at(scene, self.tracer.geometry, texture, triangle, b);
        (self.motion.texture(texture, &found) + by_b[0] * db[0] + by_b[1] * db[1]).to_array()
    }

    fn light_sample(&self, here: &MovingVertex) -> V3<Lane> {
        let tracer = self.tracer;
        let light = &here.vertices.light;
        let lit = light.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return V3::splat(0.0);
        }
        let (ids, b) = tracer.patch_corners(&light.patch, &light.s.to_array(), &light.r.to_array());
        let [q0, q1, q2] = self.motion.corners(tracer.geometry, &ids);
        let b = b.map(constant);
        let irradiance = triangle_irradiance(here.x, here.n, q0, q1, q2, b[0], b[1]);
        let y = q0 + (q1 - q0) * b[0] + (q2 - q0) * b[1];
        let tangent = if self.motion.colours {
            let (s, r) = (light.s.to_array(), light.r.to_array());
            from_lanes(&std::array::from_fn(|l| {
                let patch = &tracer.lights.patches[light.patch[l] as usize];
                let (triangle, b) = patch.triangle_at(s[l], r[l]);
                Vec3::from(self.light_tangent(patch.light as usize, triangle, b, [0.0; 2]))
            }))
        } else {
            V3::splat(0.0)
        };
        let radiance = dual_vector(tracer.light_radiance(light), tangent);
        let value = self.value_toward(here, y - here.x);
        let arrives = value.times(radiance) * (irradiance * constant(light.weight));
        V3::select(
            lit,
            tangent_of(here.throughput.times(arrives)),
            V3::splat(0.0),
        )
    }

    /// Lights without an extent.
    fn delta_lights(&self, store: &TileStore, here: &MovingVertex) -> V3<Lane> {
        let seen = &store.delta_visible[range(here.vertices.delta_lights)];
        let mut sum = V3::splat(0.0);
        let scene = self.tracer.scene;
        for ((i, light), &seen) in scene.delta_lights.iter().enumerate().zip(seen) {
            if seen == 0 {
                continue;
            }
            let still = |v: Vec3| dual_vector(splat(v), V3::splat(0.0));
            let (w, irradiance) = match light.kind {
                DeltaLightKind::Point { position } => {
                    let p = dual_vector(splat(position), splat(self.motion.delta_lights[i]));
                    (p - here.x, point_irradiance(here.x, here.n, p))
                }
                DeltaLightKind::Directional { direction } => {
                    let w = still(-direction);
                    (w, direction_irradiance(here.n, w))
                }
            };
            let power = dual_vector(
                splat(Vec3::from(scene.constant(light.power))),
                splat(Vec3::from(self.motion.texel(light.power))),
            );
            let arrives = self.value_toward(here, w).times(power) * irradiance;
            sum = sum + masked(seen, tangent_of(here.throughput.times(arrives)));
        }
        sum
    }

    /// Radiance that a moving shadow edge brings (`paths::light_cells`).
    fn light_crossing(&self, crossing: &LightCrossing, here: &MovingVertex) -> Rgb {
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
    fn bounce_crossing(&self, crossing: &BounceCrossing, here: &MovingVertex) -> Rgb {
        let lane = crossing.lane as usize;
        let x = dual_lane(here.x, lane);
        let d = self.direction_at(here, lane, crossing.local);
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
        let zero = Dual::<f64>::splat(0.0);
        let none = RoughTransmission {
            at_in: zero,
            by_cos_in: zero,
            by_alpha_in: zero,
            at_out: zero,
            by_cos_out: zero,
            by_alpha_out: zero,
            inner: zero,
            by_alpha_inner: zero,
        };
        let kinds = &vertices.kinds;
        let (direction, _) = interface_bounce(
            n,
            dual_lane(here.direction, lane),
            lx,
            ly,
            lz,
            interface,
            none,
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

/// A number that does not move.
pub fn constant(value: Lane) -> D {
    Dual {
        value,
        tangent: Lane::splat(0.0),
    }
}

fn value_of(v: V3<D>) -> V3<Lane> {
    V3 {
        x: v.x.value,
        y: v.y.value,
        z: v.z.value,
    }
}

fn dual_number(d: D, lane: usize) -> Dual<f64> {
    Dual {
        value: d.value.to_array()[lane] as f64,
        tangent: d.tangent.to_array()[lane] as f64,
    }
}

fn dual_lane(v: V3<D>, lane: usize) -> V3<Dual<f64>> {
    V3 {
        x: dual_number(v.x, lane),
        y: dual_number(v.y, lane),
        z: dual_number(v.z, lane),
    }
}

fn add_lane(v: V3<Lane>, lane: u8, value: Rgb) -> V3<Lane> {
    let add = |x: Lane, y: f32| {
        let mut x = x.to_array();
        x[lane as usize] += y;
        Lane::new(x)
    };
    V3 {
        x: add(v.x, value[0]),
        y: add(v.y, value[1]),
        z: add(v.z, value[2]),
    }
}

pub(super) fn range(r: [u32; 2]) -> std::ops::Range<usize> {
    r[0] as usize..r[1] as usize
}
