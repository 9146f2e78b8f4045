//! The forward sweep over samples that move: from the velocities of what they follow to those of
//! their directions and weights.

use crate::gradient::path::forward::{
    Arriving, D, ForwardSweep, MovingVertex, constant, dual_lane, value_of,
};
use crate::gradient::scene::forward::{dual_vector, tangent_of};
use crate::kernels::light::direction_irradiance;
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{Dual, LANES, Lane, Real, V3};
use crate::paths::film::drift::Followed;
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked};
use crate::paths::store::{MovingFilmPath, TileStore};
use crate::paths::surface::kinds::LightKind;
use crate::paths::warp::follow::Follow;
use crate::paths::warp::kernel::per_solid_angle;
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};

impl Follow {
    /// As the film follows it, from the film point at which it is seen.
    pub(crate) fn on_film(&self, geometry: &Geometry, at: [f64; 2]) -> Followed {
        Followed {
            triangle: geometry.triangles[self.triangle as usize],
            barycentrics: self.weights(),
            at,
            share: f64::from(self.share),
        }
    }
}

/// How a path of the film changes.
pub struct MovingFilm {
    /// Of its film points, in pixels.
    pub velocity: [Lane; 2],
    /// Of its radiance where they go, and by its score.
    pub derivative: V3<Lane>,
}

impl ForwardSweep<'_> {
    /// How a path of the film changes whose samples move.
    pub fn moving_film(&self, store: &TileStore, path: usize) -> MovingFilm {
        let film_path = &store.film_paths[path];
        let (velocity, score) = self.film_motion(store, film_path);
        let scored = self.view.scored(store, path);
        let at = [0, 1].map(|i| Dual {
            value: film_path.at[i],
            tangent: velocity[i],
        });
        let along = self.path_derivative(store, path, at, &scored, &mut |_, _| ());
        MovingFilm {
            velocity,
            derivative: along + scored[0].radiance * score,
        }
    }

    /// The velocities of a path's film points, and their scores.
    fn film_motion(&self, store: &TileStore, path: &MovingFilmPath) -> ([Lane; 2], Lane) {
        let mut velocity = [[0.0; LANES]; 2];
        let mut score = [0.0; LANES];
        let geometry = self.view.geometry;
        for follow in store.followed(path.follows) {
            let lane = follow.lane as usize;
            let seen = self.view.camera.film_point(follow.point(geometry));
            let followed = follow.on_film(geometry, seen);
            let [x, y] = self.film_velocity(&followed).map(|v| v as f32);
            velocity[0][lane] += follow.share * x;
            velocity[1][lane] += follow.share * y;
            score[lane] += follow.score[0] * x + follow.score[1] * y;
        }
        (velocity.map(Lane::new), Lane::new(score))
    }

    /// How directions at a vertex turn, and their scores.
    pub(crate) fn turning(
        &self,
        here: &MovingVertex,
        follows: &[Follow],
        direction: V3<Lane>,
    ) -> (V3<Lane>, Lane) {
        let mut turning = [Vec3::ZERO; LANES];
        let mut score = [0.0; LANES];
        for follow in follows {
            let lane = follow.lane as usize;
            let spin = self.spin(here, follow);
            let share = f64::from(follow.share);
            let d = lane_of(direction, lane).as_dvec3();
            turning[lane] += (share * spin.cross(d)).as_vec3();
            score[lane] += Vec3::from(follow.score).as_dvec3().dot(spin) as f32;
        }
        (from_lanes(&turning), Lane::new(score))
    }

    /// Ω of a point that a vertex follows.
    fn spin(&self, here: &MovingVertex, follow: &Follow) -> DVec3 {
        let geometry = self.view.geometry;
        let corners = geometry.triangles[follow.triangle as usize];
        let [p, q, r] = corners.map(|v| self.motion.point(geometry, v));
        let [b0, b1, b2] = follow.weights().map(Dual::<f64>::splat);
        let to = p * b0 + q * b1 + r * b2 - dual_lane(here.x, follow.lane as usize);
        let dvec = |of: fn(Dual<f64>) -> f64| DVec3::new(of(to.x), of(to.y), of(to.z));
        let (d, velocity) = (dvec(|d| d.value), dvec(|d| d.tangent));
        d.cross(velocity) / d.length_squared()
    }

    /// Has the bounces of a vertex move, of which `chain` holds how they would rest in their lobes;
    /// returns what their scores bring, by which `scored` is multiplied.
    pub(crate) fn turn_bounce(
        &self,
        store: &TileStore,
        here: &MovingVertex,
        chain: &mut Arriving,
        scored: V3<Lane>,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let world = vertices.warped.world;
        if world == 0 {
            return V3::splat(0.0);
        }
        let follows = store.followed(vertices.warped.bounce_follows);
        let (turning, score) = self.turning(here, follows, vertices.local);
        let (direction, weight) = self.bounce_in_world(here, turning);
        let is_world = lane_mask(world);
        let throughput = here.throughput.times(weight) * constant(vertices.survival);
        chain.direction = V3::select(is_world, direction, chain.direction);
        chain.throughput = V3::select(is_world, throughput, chain.throughput);
        masked(world, scored * score)
    }

    /// What a sample of the environment map brings, if there is one, whose direction moves and
    /// whose score multiplies `scored`.
    pub(crate) fn moving_environment_sample(
        &self,
        store: &TileStore,
        here: &MovingVertex,
        scored: V3<Lane>,
    ) -> V3<Lane> {
        let Some(sample) = store.environment_sample(here.vertices) else {
            return V3::splat(0.0);
        };
        let follows = store.followed(here.vertices.warped.environment_follows);
        let (turning, score) = self.turning(here, follows, sample.direction);
        let seen = sample.weight.gt(Lane::splat(0.0)).to_bits();
        let along = self.turning_environment(here, sample.direction, sample.weight, turning);
        masked(seen, along) + scored * score
    }

    /// The bounce of lanes that draw directions of the world: the direction, and what the path is
    /// multiplied with.
    fn bounce_in_world(&self, here: &MovingVertex, turning: V3<Lane>) -> (V3<D>, V3<D>) {
        let vertices = here.vertices;
        let w = dual_vector(vertices.local, turning);
        let mut lobe = self.bsdf_evaluate(here, w, LightKind::Delta);
        if vertices.kinds.plastic != 0 {
            let diffuse = self.bsdf_evaluate(here, w, LightKind::Diffuse);
            let is_diffuse = lane_mask(vertices.lobes.diffuse);
            lobe = V3::select(is_diffuse, diffuse, lobe - diffuse);
        }
        let weight = per_solid_angle(lobe, here.n, w);
        (w, weight * constant(vertices.inverse_density))
    }

    /// Light samples whose directions move.
    pub(crate) fn moving_light_sample(&self, store: &TileStore, here: &MovingVertex) -> V3<Lane> {
        let view = self.view;
        let vertices = here.vertices;
        let light = &vertices.light;
        let (s, r) = (light.s.to_array(), light.r.to_array());
        let direction = (view.patch_points(&light.patch, &s, &r) - value_of(here.x)).normalize();
        let follows = store.followed(vertices.warped.light_follows);
        let (turning, score) = self.turning(here, follows, direction);
        let w = dual_vector(direction, turning);
        let irradiance = direction_irradiance(here.n, w);
        // Per solid angle in place of the light's area.
        let weight = constant(light.weight * light.irradiance / irradiance.value);
        let radiance = dual_vector(
            view.light_radiance(light),
            self.light_passing(here, w, &light.patch, [&s, &r]),
        );
        let value = self.bsdf_evaluate(here, w, LightKind::Sampled);
        let brings = here.throughput.times(value.times(radiance)) * (irradiance * weight);
        let sum = tangent_of(brings) + value_of(brings) * score;
        masked(vertices.warped.light, sum)
    }

    /// How the radiance changes where moving rays `w` meet the patches of lights.
    fn light_passing(
        &self,
        here: &MovingVertex,
        w: V3<D>,
        patch: &[u32; LANES],
        [s, r]: [&[f32; LANES]; 2],
    ) -> V3<Lane> {
        let view = self.view;
        if !self.motion.colours && !view.lights.any_texture {
            return V3::splat(0.0);
        }
        let places: [(u32, [f32; 2]); LANES] =
            std::array::from_fn(|l| view.lights.patches[patch[l] as usize].triangle_at(s[l], r[l]));
        let ids = view.geometry.corners(&places.map(|(triangle, _)| triangle));
        let [v0, v1, v2] = self.motion.corners(view.geometry, &ids);
        let (_, b1, b2) = triangle_hit(here.x, w, v0, v1, v2);
        let (db1, db2) = (b1.tangent.to_array(), b2.tangent.to_array());
        from_lanes(&std::array::from_fn(|l| {
            let light = view.lights.patches[patch[l] as usize].light as usize;
            let (triangle, b) = places[l];
            Vec3::from(self.light_tangent(light, triangle, b, [db1[l], db2[l]]))
        }))
    }
}
