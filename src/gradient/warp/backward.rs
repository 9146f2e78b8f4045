//! The backward sweep over samples that move; see `forward`.

use crate::adjoint::light::direction_irradiance_adjoint;
use crate::adjoint::triangle::triangle_hit_adjoint;
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, TurningBars, VertexBars};
use crate::gradient::scene::backward::TileSums;
use crate::kernels::light::direction_irradiance;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::environment::map;
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked};
use crate::paths::store::{EnvironmentSample, MovingFilmPath, TileStore};
use crate::paths::surface::kinds::LightKind;
use crate::paths::warp::follow::Follow;
use glam::{DVec3, Vec3};

impl BackwardSweep<'_> {
    /// Adds the gradient of a path of the film whose samples move, given the cotangents of its
    /// radiances and those that its film points have besides.
    pub fn add_moving_film(
        &self,
        store: &TileStore,
        path: usize,
        (radiance_bar, at_bars): (V3<Lane>, [Lane; 2]),
        sums: &mut TileSums,
    ) {
        let film_path = &store.film_paths[path];
        let scored = self.view.scored(store, path);
        let bars = (radiance_bar, scored.as_slice());
        let along = self.add_scored_path(store, path, film_path.at, bars, sums);
        let velocity = [0, 1].map(|i| (along[i] + at_bars[i]).to_array());
        let all = radiance_bar.times(scored[0].radiance);
        let score = (all.x + all.y + all.z).to_array();
        if self.wanted.attached() {
            self.add_film_motion(store, film_path, velocity, score, sums);
        }
    }

    /// To what the film points of a path follow, from the cotangents of their velocities and
    /// scores.
    fn add_film_motion(
        &self,
        store: &TileStore,
        path: &MovingFilmPath,
        velocity: [[f32; LANES]; 2],
        score: [f32; LANES],
        sums: &mut TileSums,
    ) {
        let geometry = self.view.geometry;
        for follow in store.followed(path.follows) {
            let lane = follow.lane as usize;
            let seen = self.view.camera.film_point(follow.point(geometry));
            let followed = follow.on_film(geometry, seen);
            let bar = [0, 1].map(|i| {
                f64::from(follow.share * velocity[i][lane] + follow.score[i] * score[lane])
            });
            self.add_followed(&followed, bar, sums);
        }
    }

    /// To what directions at a vertex follow.
    pub(crate) fn add_turning(
        &self,
        here: &Solved,
        (follows, direction): (&[Follow], V3<Lane>),
        turning: &TurningBars,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        if !self.wanted.attached() {
            return;
        }
        let geometry = self.view.geometry;
        let score_bars = turning.score.to_array();
        let mut x_bars = [Vec3::ZERO; LANES];
        for follow in follows {
            let lane = follow.lane as usize;
            let d = lane_of(direction, lane).as_dvec3();
            let d_bar = lane_of(turning.direction, lane).as_dvec3();
            let score = Vec3::from(follow.score).as_dvec3();
            // (Ω×ω)·ω̄ = Ω·(ω×ω̄).
            let spin_bar =
                f64::from(follow.share) * d.cross(d_bar) + score * f64::from(score_bars[lane]);
            let to = follow.point(geometry) - lane_of(here.x, lane).as_dvec3();
            let bar: DVec3 = sums.admitted(spin_bar.cross(to) / to.length_squared());
            let corners = geometry.triangles[follow.triangle as usize];
            for (vertex, b) in corners.into_iter().zip(follow.weights()) {
                self.scatter_vertex(vertex, bar * b, sums);
            }
            x_bars[lane] -= bar.as_vec3();
        }
        bars.x = bars.x + from_lanes(&x_bars);
    }

    /// The cotangent of the direction of bounces that are directions of the world, whose weight has
    /// this cotangent.
    pub(crate) fn bounce_in_world(
        &self,
        here: &Solved,
        weight_bar: Cotangent,
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let (w, bits) = (vertices.local, weight_bar.bits);
        let weight_bar = weight_bar.value * vertices.inverse_density;
        let is_plastic = vertices.kinds.plastic != 0;
        let mut lobe = self.bsdf_evaluate(here, w, LightKind::Delta);
        let is_diffuse = lane_mask(vertices.lobes.diffuse);
        if is_plastic {
            let diffuse = self.bsdf_evaluate(here, w, LightKind::Diffuse);
            lobe = V3::select(is_diffuse, diffuse, lobe - diffuse);
        }
        let irradiance = direction_irradiance(here.n, w);
        let all = weight_bar.times(lobe);
        let (n, mut w_bar) = direction_irradiance_adjoint(here.n, w, all.x + all.y + all.z);
        bars.n = bars.n + masked(bits, n);
        w_bar = masked(bits, w_bar);
        let lobe_bar = weight_bar * irradiance;
        let diffuse = if is_plastic {
            vertices.lobes.diffuse
        } else {
            0
        };
        let own = Cotangent::of_lanes(bits & !diffuse, lobe_bar);
        w_bar = w_bar + self.bsdf_evaluate_backward(here, w, LightKind::Delta, own, bars);
        if is_plastic {
            let sign = V3::select(is_diffuse, lobe_bar, -lobe_bar);
            let own = Cotangent::of_lanes(bits, sign);
            w_bar = w_bar + self.bsdf_evaluate_backward(here, w, LightKind::Diffuse, own, bars);
        }
        w_bar
    }

    /// A sample of the environment map whose direction moves, from the cotangents of what it brings
    /// and of its score.
    pub(crate) fn moving_environment_sample(
        &self,
        store: &TileStore,
        (here, sample): (&Solved, &EnvironmentSample),
        (bar, score, bars): (Cotangent, Lane, &mut VertexBars),
        sums: &mut TileSums,
    ) {
        let scene = self.view.scene;
        let Some(environment) = &scene.environment else {
            return;
        };
        let d = sample.direction;
        let at_rest = (d, sample.weight);
        let [mut w_bar, radiance_bar] = self.environment_at_rest(here, at_rest, bar, bars, sums);
        if let Some(map) = &environment.map {
            let texture = &scene.textures[environment.radiance];
            let turned: [Vec3; LANES] = std::array::from_fn(|lane| {
                if bar.bits >> lane & 1 == 0 {
                    return Vec3::ZERO;
                }
                let found = map::lookup(texture, map, lane_of(d, lane));
                let radiance_bar = lane_of(radiance_bar, lane);
                let [u, v] = found.by_uv.map(|by| by.dot(radiance_bar));
                found.by_direction[0] * u + found.by_direction[1] * v
            });
            let turned = from_lanes(&turned);
            if self.wanted.environment {
                // The direction turns by −ω × d as the map sees it.
                let turn = sums.over_lanes(turned.cross(d), bar.bits);
                sums.add_environment(turn, 0.0);
            }
            w_bar = w_bar + turned;
        }
        let turning = TurningBars {
            direction: w_bar,
            score,
        };
        let follows = store.followed(here.vertices.warped.environment_follows);
        self.add_turning(here, (follows, d), &turning, bars, sums);
    }

    /// Light samples whose directions move.
    pub(crate) fn moving_light_sample(
        &self,
        store: &TileStore,
        here: &Solved,
        radiance_bar: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let view = self.view;
        let vertices = here.vertices;
        let bits = vertices.warped.light;
        if bits == 0 {
            return;
        }
        let light = &vertices.light;
        let (s, r) = (light.s.to_array(), light.r.to_array());
        let w = (view.patch_points(&light.patch, &s, &r) - here.x).normalize();
        let irradiance = direction_irradiance(here.n, w);
        let weight = light.weight * light.irradiance / irradiance;
        let emitted = view.light_radiance(light);
        let value = self.bsdf_evaluate(here, w, LightKind::Sampled);
        let throughput = vertices.throughput;
        let radiance_bar = masked(bits, radiance_bar * weight);
        let brings = value.times(emitted) * irradiance;
        bars.throughput = bars.throughput + radiance_bar.times(brings);
        let on = radiance_bar.times(throughput);
        let value_bar = Cotangent::of_lanes(bits, on.times(emitted) * irradiance);
        let mut w_bar = self.bsdf_evaluate_backward(here, w, LightKind::Sampled, value_bar, bars);
        let all = on.times(value).times(emitted);
        let (n, by_cos) = direction_irradiance_adjoint(here.n, w, all.x + all.y + all.z);
        bars.n = bars.n + masked(bits, n);
        w_bar = w_bar + masked(bits, by_cos);
        let emitted_bar = Cotangent::of_lanes(bits, on.times(value) * irradiance);
        w_bar = w_bar + self.light_passing(here, (w, [&s, &r]), emitted_bar, bars, sums);
        let all = radiance_bar.times(throughput).times(brings);
        let turning = TurningBars {
            direction: w_bar,
            score: all.x + all.y + all.z,
        };
        let follows = store.followed(vertices.warped.light_follows);
        self.add_turning(here, (follows, w), &turning, bars, sums);
    }

    /// From the radiance where rays `w` meet the patches of lights; returns the cotangent of `w`.
    fn light_passing(
        &self,
        here: &Solved,
        (w, [s, r]): (V3<Lane>, [&[f32; LANES]; 2]),
        emitted_bar: Cotangent,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> V3<Lane> {
        let view = self.view;
        let zero = V3::splat(0.0);
        if !self.wanted.colours() && !view.lights.any_texture {
            return zero;
        }
        let patch = &here.vertices.light.patch;
        let mut triangle = [0; LANES];
        let mut b_bar = [[0.0; LANES]; 2];
        for lane in 0..LANES {
            let patch = &view.lights.patches[patch[lane] as usize];
            let (own, b) = patch.triangle_at(s[lane], r[lane]);
            triangle[lane] = own;
            if emitted_bar.bits >> lane & 1 == 1 {
                let bar = lane_of(emitted_bar.value, lane);
                let slopes = self.add_light_texels(patch.light as usize, own, b, bar, sums);
                for (sum, by) in b_bar.iter_mut().zip(slopes) {
                    sum[lane] = by.dot(bar);
                }
            }
        }
        if !self.wanted.attached() {
            return zero;
        }
        let ids = view.geometry.corners(&triangle);
        let [v0, v1, v2] = view.geometry.gather_positions(&ids);
        let [b1, b2] = b_bar.map(Lane::new);
        let still = Lane::splat(0.0);
        let (x, w_bar, v0, v1, v2) = triangle_hit_adjoint(here.x, w, v0, v1, v2, (still, b1, b2));
        let bits = emitted_bar.bits;
        bars.x = bars.x + masked(bits, x);
        self.scatter(&triangle, &ids, [v0, v1, v2], bits, sums);
        masked(bits, w_bar)
    }
}
