//! The backward sweep over light: emission that rays found, light samples, the environment.

use crate::adjoint::bsdf::bsdf_evaluate_adjoint;
use crate::adjoint::layered::layered_evaluate_adjoint;
use crate::adjoint::light::{direction_irradiance_adjoint, triangle_irradiance_adjoint};
use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, VertexBars};
use crate::gradient::scene::backward::TileSums;
use crate::kernels::bsdf::bsdf_evaluate;
use crate::kernels::layered::layered_evaluate;
use crate::kernels::light::{direction_irradiance, triangle_irradiance};
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::environment::map;
use crate::paths::rays::{lane_mask, lane_of, masked};
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::relief::shown;
use crate::trace::geometry::gather;
use glam::{DVec3, Vec3};

impl BackwardSweep<'_> {
    /// π times the BSDF toward `w`, of what this kind of light lights.
    pub(crate) fn bsdf_evaluate(&self, here: &Solved, w: V3<Lane>, light: LightKind) -> V3<Lane> {
        self.shown(here, w, self.unhidden(here, w, light))
    }

    /// The same but for what a turned surface hides of itself.
    fn unhidden(&self, here: &Solved, w: V3<Lane>, light: LightKind) -> V3<Lane> {
        let vertices = here.vertices;
        let Some(interface) = &here.interface else {
            return vertices.diffuse_reflectance;
        };
        let [lit, lobes] = vertices.kinds.lit_by(light);
        let value = bsdf_evaluate(
            here.n,
            vertices.direction,
            w,
            *interface,
            self.view
                .transmission(vertices, here.n, here.n.dot(w.normalize())),
            vertices.kinds.masks(),
            lane_mask(lobes),
        );
        let kinds = &vertices.kinds;
        let value = match &here.layers {
            None => value,
            Some((layers, _)) => {
                let (n, direction) = (here.n, vertices.direction);
                let lit = kinds.lit_masks(light);
                let layered =
                    layered_evaluate(n, direction, w, *interface, *layers, kinds.masks(), lit);
                V3::select(lane_mask(kinds.layered()), layered, value)
            }
        };
        masked(lit, value)
    }

    /// The part of what is sent toward or from `w` that turned surfaces do not hide.
    pub(crate) fn shown(&self, here: &Solved, w: V3<Lane>, value: V3<Lane>) -> V3<Lane> {
        if here.vertices.kinds.relief == 0 {
            return value;
        }
        value * shown(here.vertices, here.base_n, here.n, w)
    }

    /// Adds to the cotangents of the vertex from that of the BSDF, and returns that of `w`.
    pub(crate) fn bsdf_evaluate_backward(
        &self,
        here: &Solved,
        w: V3<Lane>,
        light: LightKind,
        bar: Cotangent,
        bars: &mut VertexBars,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let Some(interface) = &here.interface else {
            bars.interface.reflectance = bars.interface.reflectance + masked(bar.bits, bar.value);
            return V3::splat(0.0);
        };
        let kinds = &vertices.kinds;
        let [lit, lobes] = kinds.lit_by(light);
        let bits = bar.bits & lit;
        let mut bar = bar;
        let mut layered_w = V3::splat(0.0);
        let mut hidden_w = V3::splat(0.0);
        if kinds.relief != 0 {
            let value = self.unhidden(here, w, light);
            let own = Cotangent::of_lanes(bits, bar.value);
            (hidden_w, bar.value) = self.shown_backward(here, (w, value), own, bars);
        }
        if let Some((layers, _)) = &here.layers {
            let bits = bits & kinds.layered();
            let (n, direction, w_bar, s, l) = layered_evaluate_adjoint(
                here.n,
                vertices.direction,
                w,
                *interface,
                *layers,
                kinds.masks(),
                kinds.lit_masks(light),
                masked(bits, bar.value),
            );
            bars.n = bars.n + masked(bits, n);
            bars.direction = bars.direction + masked(bits, direction);
            bars.add_interface(bits, &s);
            bars.add_layers(bits, &l);
            layered_w = masked(bits, w_bar);
        }
        let bits = bits & !kinds.layered();
        let (n, direction, w_bar, s, _) = bsdf_evaluate_adjoint(
            here.n,
            vertices.direction,
            w,
            *interface,
            self.view
                .transmission(vertices, here.n, here.n.dot(w.normalize())),
            vertices.kinds.masks(),
            lane_mask(lobes),
            masked(bits, bar.value),
        );
        bars.n = bars.n + masked(bits, n);
        bars.direction = bars.direction + masked(bits, direction);
        bars.add_interface(bits, &s);
        hidden_w + layered_w + masked(bits, w_bar)
    }

    /// See `forward::ForwardSweep::emission`. `earlier` are the cotangents of the vertex `before`.
    pub(crate) fn emission(
        &self,
        (here, before): (&Solved, Option<&Solved>),
        radiance_bar: V3<Lane>,
        bars: &mut VertexBars,
        earlier: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let vertices = here.vertices;
        let zero = Lane::splat(0.0);
        let weight = vertices.emission_weight;
        let on_light = self.lanes_on_lights(here);
        let bits = weight.gt(zero).to_bits() & vertices.hit & on_light;
        if bits == 0 {
            return;
        }
        let emitted = self.view.emission(vertices);
        let seen = bits & !vertices.sampled;
        let weighted = radiance_bar * weight;
        bars.arriving = bars.arriving + masked(seen, weighted.times(emitted));
        let mut emitted_bar = masked(seen, weighted.times(vertices.arriving_throughput()));
        let sampled = bits & vertices.sampled;
        if let (Some(from), true) = (before, sampled != 0) {
            let weighted = masked(sampled, weighted);
            let throughput = from.vertices.throughput;
            let [q0, q1, q2] = here.corners;
            let [b1, b2] = here.b;
            let irradiance = triangle_irradiance(from.x, from.n, [q0, q1, q2], b1, b2);
            let w = q0 + (q1 - q0) * b1 + (q2 - q0) * b2 - from.x;
            let value = self.bsdf_evaluate(from, w, LightKind::Sampled);
            let brings = weighted.times(emitted) * irradiance;
            earlier.throughput = earlier.throughput + masked(sampled, brings.times(value));
            emitted_bar = emitted_bar
                + masked(
                    sampled,
                    weighted.times(throughput).times(value) * irradiance,
                );
            let value_bar = brings.times(throughput);
            let value_bar = Cotangent::of_lanes(sampled, value_bar);
            let w_bar =
                self.bsdf_evaluate_backward(from, w, LightKind::Sampled, value_bar, earlier);
            if self.wanted.attached() {
                let all = weighted.times(emitted).times(throughput).times(value);
                let (x, n, [v0, v1, v2], _, _) = triangle_irradiance_adjoint(
                    from.x,
                    from.n,
                    here.corners,
                    b1,
                    b2,
                    all.x + all.y + all.z,
                );
                earlier.x = earlier.x + masked(sampled, x - w_bar);
                earlier.n = earlier.n + masked(sampled, n);
                let one = Lane::splat(1.0);
                let moved = [
                    v0 + w_bar * (one - b1 - b2),
                    v1 + w_bar * b1,
                    v2 + w_bar * b2,
                ];
                self.scatter(&vertices.triangle, &here.ids, moved, sampled, sums);
            }
        }
        let emitted_bar = Cotangent::of_lanes(bits, emitted_bar);
        self.emission_texels(here, emitted_bar, seen, bars, sums);
    }

    /// Lanes on the lit side of a light.
    fn lanes_on_lights(&self, here: &Solved) -> u32 {
        let view = self.view;
        (0..LANES)
            .filter(|&l| here.vertices.hit >> l & 1 == 1)
            .filter(|&l| {
                let t = here.vertices.triangle[l] as usize;
                let mesh = view.geometry.mesh_of_triangle[t] as usize;
                view.lights.of_mesh[mesh].is_some() && view.sees_front(here.vertices, l)
            })
            .fold(0, |bits, l| bits | 1 << l)
    }

    /// From the radiance that is emitted to its texels; in lanes of `seen` also to where on the
    /// light that is.
    fn emission_texels(
        &self,
        here: &Solved,
        emitted_bar: Cotangent,
        seen: u32,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let view = self.view;
        if !self.wanted.colours() && !view.lights.any_texture {
            return;
        }
        let (b1, b2) = (here.b[0].to_array(), here.b[1].to_array());
        let mut b_bar = bars.b.map(Lane::to_array);
        for lane in (0..LANES).filter(|&l| emitted_bar.bits >> l & 1 == 1) {
            let triangle = here.vertices.triangle[lane];
            let mesh = view.geometry.mesh_of_triangle[triangle as usize] as usize;
            let Some(light) = view.lights.of_mesh[mesh] else {
                continue;
            };
            let at = [b1[lane], b2[lane]];
            let bar = lane_of(emitted_bar.value, lane);
            let slopes = self.add_light_texels(light as usize, triangle, at, bar, sums);
            if seen >> lane & 1 == 1 {
                for (sum, by) in b_bar.iter_mut().zip(slopes) {
                    sum[lane] += by.dot(bar);
                }
            }
        }
        bars.b = b_bar.map(Lane::new);
    }

    /// Adds to the texels of a light's radiance at a point of a triangle; returns the slopes over
    /// the barycentrics.
    pub(crate) fn add_light_texels(
        &self,
        light: usize,
        triangle: u32,
        b: [f32; 2],
        bar: Vec3,
        sums: &mut TileSums,
    ) -> [Vec3; 2] {
        let scene = self.view.scene;
        let texture = scene.area_lights[light].radiance;
        let (found, slopes) = texture_at(scene, self.view.geometry, texture, triangle, b);
        sums.add_texture(self.wanted, texture, &found, bar);
        slopes
    }

    pub(crate) fn light_sample(
        &self,
        here: &Solved,
        radiance_bar: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let view = self.view;
        let vertices = here.vertices;
        let light = &vertices.light;
        let lit = light.weight.gt(Lane::splat(0.0));
        let bits = lit.to_bits() & !vertices.warped.light;
        if bits == 0 {
            return;
        }
        let emitted = view.light_radiance(light);
        let scale = light.irradiance * light.weight;
        let path = masked(bits, radiance_bar.times(vertices.throughput));
        let own = masked(bits, radiance_bar.times(light.value).times(emitted) * scale);
        bars.throughput = bars.throughput + own;
        if self.wanted.colours() {
            let emitted_bar = path.times(light.value) * scale;
            let (s, r) = (light.s.to_array(), light.r.to_array());
            for lane in (0..LANES).filter(|&l| bits >> l & 1 == 1) {
                let patch = &view.lights.patches[light.patch[lane] as usize];
                let (triangle, b) = patch.triangle_at(s[lane], r[lane]);
                let bar = lane_of(emitted_bar, lane);
                self.add_light_texels(patch.light as usize, triangle, b, bar, sums);
            }
        }
        let (ids, [b1, b2]) =
            view.patch_corners(&light.patch, &light.s.to_array(), &light.r.to_array());
        let [q0, q1, q2] = gather(&ids, |v, _| view.geometry.positions[v as usize]);
        let w = q0 + (q1 - q0) * b1 + (q2 - q0) * b2 - here.x;
        let value_bar = Cotangent::of_lanes(bits, path.times(emitted) * scale);
        let w_bar = self.bsdf_evaluate_backward(here, w, LightKind::Sampled, value_bar, bars);
        if !self.wanted.attached() {
            return;
        }
        let all = path.times(light.value).times(emitted) * light.weight;
        let irradiance_bar = all.x + all.y + all.z;
        let (x, n, [v0, v1, v2], _, _) =
            triangle_irradiance_adjoint(here.x, here.n, [q0, q1, q2], b1, b2, irradiance_bar);
        let triangle = light.patch.map(|p| self.light_triangle(p));
        let one = Lane::splat(1.0);
        let moved = [
            v0 + w_bar * (one - b1 - b2),
            v1 + w_bar * b1,
            v2 + w_bar * b2,
        ];
        self.scatter(&triangle, &ids, moved, bits, sums);
        bars.x = bars.x + masked(bits, x - w_bar);
        bars.n = bars.n + masked(bits, n);
    }

    /// Any triangle of the mesh that a patch belongs to.
    fn light_triangle(&self, patch: u32) -> u32 {
        let light = self.view.lights.patches[patch as usize].light as usize;
        self.view.geometry.first_triangle[self.view.scene.area_lights[light].mesh]
    }

    /// What the environment map brings to a vertex from `direction`, which keeps its place on the
    /// map, with this weight.
    pub(crate) fn environment_brings(
        &self,
        here: &Solved,
        sample: (V3<Lane>, Lane),
        bar: Cotangent,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) {
        let bits = bar.bits;
        let [w_bar, _] = self.environment_at_rest(here, sample, bar, bars, sums);
        if self.wanted.environment {
            // ω turns the direction by ω × d.
            let turn = sums.over_lanes(sample.0.cross(w_bar), bits);
            sums.add_environment(turn, 0.0);
        }
    }

    /// The same, but for where the direction is on the map. Returns the cotangents of the direction
    /// and of the radiance there.
    pub(crate) fn environment_at_rest(
        &self,
        here: &Solved,
        (direction, weight): (V3<Lane>, Lane),
        Cotangent {
            bits,
            value: radiance_bar,
        }: Cotangent,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> [V3<Lane>; 2] {
        let scene = self.view.scene;
        let Some(environment) = &scene.environment else {
            return [V3::splat(0.0); 2];
        };
        if bits == 0 {
            return [V3::splat(0.0); 2];
        }
        let irradiance = direction_irradiance(here.n, direction);
        let value = self.bsdf_evaluate(here, direction, LightKind::Sampled);
        let radiance = self.view.environment_radiance(environment, direction);
        let scaled = masked(bits, radiance_bar * weight);
        let throughput = here.vertices.throughput;
        let own = scaled.times(value).times(radiance) * irradiance;
        bars.throughput = bars.throughput + masked(bits, own);
        let path = scaled.times(throughput);
        let environment_bar = masked(bits, path.times(value) * irradiance);
        if let Some(map) = &environment.map {
            let texture = environment.radiance;
            for lane in (0..LANES).filter(|&l| bits >> l & 1 == 1) {
                let d = lane_of(direction, lane);
                let found = map::lookup(&scene.textures[texture], map, d);
                let bar = lane_of(environment_bar, lane);
                for (&texel, weight) in found.texels.iter().zip(found.weights) {
                    sums.add_texel(self.wanted, texture, texel, bar * weight);
                }
                if self.wanted.environment && sums.admits(bar.is_finite()) {
                    let scale = f64::from(found.value.dot(bar) / map.scale);
                    sums.add_environment(DVec3::ZERO, scale);
                }
            }
        }
        let value_bar = Cotangent::of_lanes(bits, path.times(radiance) * irradiance);
        let mut w_bar =
            self.bsdf_evaluate_backward(here, direction, LightKind::Sampled, value_bar, bars);
        let all = path.times(radiance).times(value);
        let irradiance_bar = all.x + all.y + all.z;
        let (n, w) = direction_irradiance_adjoint(here.n, direction, irradiance_bar);
        bars.n = bars.n + masked(bits, n);
        w_bar = w_bar + masked(bits, w);
        [w_bar, environment_bar]
    }
}
