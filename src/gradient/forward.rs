//! The tangent sweep: from stored vertices, camera side first, to the derivative of each path's radiance.

use super::motion::{Motion, MovingCamera, dual_vector, tangent_of};
use crate::kernels::camera::camera_direction;
use crate::kernels::frame::direction_from_local;
use crate::kernels::light::triangle_irradiance;
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{Dual, LANES, Lane, Mask, Real, V3};
use crate::paths::bounce_cells::BounceCrossing;
use crate::paths::store::{FilmCrossing, LightCrossing, TileStore, Vertices, lane_mask, masked};
use crate::paths::tracer::{Tracer, lane_of};
use crate::scene::Rgb;
use crate::warp::boundary::{vector, velocity_per_side};

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

/// Position and normal of a vertex, moving.
struct MovingSurface {
    x: V3<D>,
    n: V3<D>,
    corners: [V3<D>; 3],
    b1: Lane,
    b2: Lane,
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
        let mut previous: Option<MovingSurface> = None;
        for vertices in store.path(packet) {
            let (contribution, surface) =
                self.vertex(store, vertices, &mut chain, previous.as_ref());
            sum = sum + contribution;
            previous = surface;
        }
        sum
    }

    /// One vertex's contribution to the tangent; moves the chain on.
    fn vertex(
        &self,
        store: &TileStore,
        vertices: &Vertices,
        chain: &mut Chain,
        previous: Option<&MovingSurface>,
    ) -> (V3<Lane>, Option<MovingSurface>) {
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
        let surface = self.surface(vertices, chain);
        let reflectance = self.reflectance(vertices);
        if !self.tracer.lights.is_empty() {
            sum = sum
                + masked(
                    vertices.hit,
                    self.emission(vertices, chain, &surface, previous),
                );
            sum = sum + self.light_sample(vertices, chain, &surface, reflectance);
        }
        if self.visibility {
            for crossing in &store.light_crossings[range(vertices.crossings)] {
                sum = add_lane(
                    sum,
                    crossing.lane,
                    self.light_crossing(vertices, crossing, &surface),
                );
            }
            for crossing in &store.bounce_crossings[range(vertices.bounce_crossings)] {
                sum = add_lane(
                    sum,
                    crossing.lane,
                    self.bounce_crossing(vertices, crossing, &surface),
                );
            }
        }
        let [lx, ly, lz] = vertices.local.map(constant);
        chain.origin = surface.x;
        chain.direction = direction_from_local(surface.n, lx, ly, lz);
        chain.throughput = chain.throughput.times(reflectance) * constant(vertices.survival);
        (sum, Some(surface))
    }

    fn escape(&self, chain: &Chain) -> V3<Lane> {
        let value = self
            .tracer
            .scene
            .environment
            .as_ref()
            .map_or([0.0; 3], |e| self.tracer.scene.constant(e.radiance));
        let tangent = self.tracer.scene.environment.as_ref();
        let tangent = tangent.map_or([0.0; 3], |e| self.motion.texel(e.radiance));
        let radiance = constant_rgb(value, tangent);
        tangent_of(chain.throughput.times(radiance))
    }

    /// The ray's end, solved again with everything moving.
    fn surface(&self, vertices: &Vertices, chain: &Chain) -> MovingSurface {
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
        MovingSurface {
            x: chain.origin + chain.direction * t,
            n: n * constant(vertices.facing),
            corners,
            b1: b1.value,
            b2: b2.value,
        }
    }

    fn reflectance(&self, vertices: &Vertices) -> V3<D> {
        let tangent = match self.motion.colours {
            false => V3::splat(0.0),
            true => {
                let scene = self.tracer.scene;
                let lit = vertices.facing.gt(Lane::splat(0.0))
                    | lane_mask(self.tracer.two_sided(vertices));
                let tangent = self.tracer.per_lane(&vertices.triangle, |mesh, _| {
                    let bsdf = &scene.materials[scene.meshes[mesh].material].bsdf;
                    bsdf.colour().map_or([0.0; 3], |t| self.motion.texel(t))
                });
                V3::select(lit, tangent, V3::splat(0.0))
            }
        };
        dual_vector(vertices.reflectance, tangent)
    }

    /// Emission that the arriving ray found. A bounce's hit is a sample of the integral over the light's surface
    /// (`paths::tracer`): its point keeps its barycentrics, and the irradiance kernel moves.
    fn emission(
        &self,
        vertices: &Vertices,
        chain: &Chain,
        surface: &MovingSurface,
        previous: Option<&MovingSurface>,
    ) -> V3<Lane> {
        let value = self.tracer.emission(vertices);
        let tangent = match self.motion.colours {
            false => V3::splat(0.0),
            true => self
                .tracer
                .emitted(vertices, |light| self.radiance_tangent_of(light)),
        };
        let mut emitted = dual_vector(value, tangent) * constant(vertices.emission_weight);
        if let (Some(from), true) = (previous, chain.moves) {
            let [q0, q1, q2] = surface.corners;
            let irradiance = triangle_irradiance(
                from.x,
                from.n,
                q0,
                q1,
                q2,
                constant(surface.b1),
                constant(surface.b2),
            );
            // Where nothing is emitted the kernel may be 0: keep the ratio finite there.
            let zero = Lane::splat(0.0);
            let emits = vertices.emission_weight.gt(zero) & irradiance.value.gt(zero);
            let relative =
                <Lane as Real>::select(emits, irradiance.tangent / irradiance.value, zero);
            emitted = emitted
                * Dual {
                    value: Lane::splat(1.0),
                    tangent: relative,
                };
        }
        tangent_of(chain.throughput.times(emitted))
    }

    fn light_sample(
        &self,
        vertices: &Vertices,
        chain: &Chain,
        surface: &MovingSurface,
        reflectance: V3<D>,
    ) -> V3<Lane> {
        let light = &vertices.light;
        let lit = light.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return V3::splat(0.0);
        }
        let (ids, b) =
            self.tracer
                .patch_corners(&light.patch, &light.s.to_array(), &light.r.to_array());
        let [q0, q1, q2] = self.motion.corners(self.tracer.geometry, &ids);
        let irradiance = triangle_irradiance(
            surface.x,
            surface.n,
            q0,
            q1,
            q2,
            constant(b[0]),
            constant(b[1]),
        );
        let radiance = self.light_radiance(&light.patch);
        let value = radiance * (irradiance * constant(light.weight));
        V3::select(
            lit,
            tangent_of(chain.throughput.times(reflectance).times(value)),
            V3::splat(0.0),
        )
    }

    fn radiance_tangent_of(&self, light: usize) -> Rgb {
        self.motion
            .texel(self.tracer.scene.area_lights[light].radiance)
    }

    fn light_radiance(&self, patch: &[u32; LANES]) -> V3<D> {
        let tangent = match self.motion.colours {
            false => V3::splat(0.0),
            true => self
                .tracer
                .per_patch(patch, |light| self.radiance_tangent_of(light)),
        };
        dual_vector(self.tracer.light_radiance(patch), tangent)
    }

    /// Radiance that a moving shadow edge brings (`paths::light_cells`).
    fn light_crossing(
        &self,
        vertices: &Vertices,
        crossing: &LightCrossing,
        surface: &MovingSurface,
    ) -> Rgb {
        let lane = crossing.lane as usize;
        let x = dual_lane(surface.x, lane);
        let (ids, b) = self.tracer.lights.patches[crossing.patch as usize]
            .vertices_at(crossing.at[0] as f32, crossing.at[1] as f32);
        let [q0, q1, q2] = ids.map(|v| self.motion.point(self.tracer.geometry, v));
        let [b1, b2] = b.map(|b| Dual::<f64>::splat(b as f64));
        let y = q0 + (q1 - q0) * b1 + (q2 - q0) * b2;
        let side = crossing
            .boundary
            .side(x, y - x, |v| self.motion.point(self.tracer.geometry, v));
        let Some(weight) =
            crossing.radiance_per_side(self.tracer, vertices, lane_of(value_of(surface.n), lane))
        else {
            return [0.0; 3];
        };
        weight.map(|w| (w * side.tangent) as f32)
    }

    /// Radiance that a silhouette brings that moves over the hemisphere (`paths::bounce_cells`).
    fn bounce_crossing(
        &self,
        vertices: &Vertices,
        crossing: &BounceCrossing,
        surface: &MovingSurface,
    ) -> Rgb {
        let lane = crossing.lane as usize;
        let x = dual_lane(surface.x, lane);
        let n = dual_lane(surface.n, lane);
        let [lx, ly, lz] = crossing.local.map(Dual::<f64>::splat);
        let d = direction_from_local(n, lx, ly, lz);
        let side = crossing
            .boundary
            .side(x, d, |v| self.motion.point(self.tracer.geometry, v));
        let Some(weight) = crossing.radiance_per_side(self.tracer, vertices) else {
            return [0.0; 3];
        };
        weight.map(|w| (w * side.tangent) as f32)
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

impl FilmCrossing {
    /// Film velocity along the crossing's axis, in pixels, per unit of Ḟ.
    pub fn velocity_per_side(&self, tracer: &Tracer) -> Option<f64> {
        let c = self
            .boundary
            .normal(tracer.geometry, tracer.camera.origin.as_dvec3());
        let gradient = tracer.camera.direction_per_pixel().map(|d| c.dot(d));
        velocity_per_side(gradient, [1.0, 0.0, 1.0], self.axis as usize)
    }
}

impl LightCrossing {
    /// Radiance of the path per unit of Ḟ, all at θ₀: throughput · reflectance · Le · irradiance · jump · V/Ḟ over the
    /// probability of the patch. `n` is the unit normal the light falls on.
    pub fn radiance_per_side(
        &self,
        tracer: &Tracer,
        vertices: &Vertices,
        n: glam::Vec3,
    ) -> Option<[f64; 3]> {
        let lane = self.lane as usize;
        let geometry = tracer.geometry;
        let patch = &tracer.lights.patches[self.patch as usize];
        let x = vertices.position(geometry, lane);
        let c = self.boundary.normal(geometry, x);
        let edges = patch.edges.map(|e| e.as_dvec3());
        let gradient = edges.map(|e| c.dot(e));
        let metric = [
            edges[0].dot(edges[0]),
            edges[0].dot(edges[1]),
            edges[1].dot(edges[1]),
        ];
        let velocity = velocity_per_side(gradient, metric, self.axis as usize)?;
        let (ids, [b1, b2]) = patch.vertices_at(self.at[0] as f32, self.at[1] as f32);
        let [q0, q1, q2] = ids.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
        let irradiance = triangle_irradiance(
            vector(x),
            vector(n.as_dvec3()),
            q0,
            q1,
            q2,
            b1 as f64,
            b2 as f64,
        );
        let scale = irradiance * self.jump * velocity / patch.probability as f64;
        let colour = vertices.throughput.times(vertices.reflectance);
        let colour = lane_of(colour, lane).to_array();
        let radiance = tracer
            .scene
            .constant(tracer.scene.area_lights[patch.light as usize].radiance);
        Some(std::array::from_fn(|i| {
            scale * (colour[i] * radiance[i]) as f64
        }))
    }
}

/// A number that does not move.
pub fn constant(value: Lane) -> D {
    Dual {
        value,
        tangent: Lane::splat(0.0),
    }
}

fn constant_rgb(value: Rgb, tangent: Rgb) -> V3<D> {
    let dual = |c: usize| Dual {
        value: Lane::splat(value[c]),
        tangent: Lane::splat(tangent[c]),
    };
    V3 {
        x: dual(0),
        y: dual(1),
        z: dual(2),
    }
}

fn value_of(v: V3<D>) -> V3<Lane> {
    V3 {
        x: v.x.value,
        y: v.y.value,
        z: v.z.value,
    }
}

fn dual_lane(v: V3<D>, lane: usize) -> V3<Dual<f64>> {
    let of = |d: D| Dual {
        value: d.value.to_array()[lane] as f64,
        tangent: d.tangent.to_array()[lane] as f64,
    };
    V3 {
        x: of(v.x),
        y: of(v.y),
        z: of(v.z),
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
