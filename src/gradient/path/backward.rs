//! The backward sweep: from stored vertices, last to first, to the cotangents of everything that
//! was asked for.
//!
//! No ray is traced. Each vertex is solved again from its stored ray, the generated adjoints of the
//! kernels carry the cotangents of position, normal, direction and throughput toward the camera,
//! and what reaches a triangle's vertices, a texel or the camera is added to the tile's sums.

use crate::adjoint::bsdf::bsdf_sample_adjoint;
use crate::adjoint::frame::direction_from_local_adjoint;
use crate::adjoint::layered::layered_sample_adjoint;
use crate::adjoint::relief::relief_shadow_adjoint;
use crate::gradient::path::bars::{Cotangent, TurningBars, VertexBars};
use crate::gradient::scene::backward::TileSums;
use crate::gradient::scene::camera_ray::camera_ray_adjoint;
use crate::gradient::scene::wanted::Wanted;
use crate::kernels::bsdf::{Interface, bsdf_sample};
use crate::kernels::layered::{Layers, layered_sample};
use crate::kernels::relief::relief_shadow;
use crate::lanes::{LANES, Lane, Mask, Real, V3};
use crate::paths::environment::map;
use crate::paths::film::drift::Drift;
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::radiance::Scored;
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked};
use crate::paths::relayed::lanes;
use crate::paths::scene_view::SceneView;
use crate::paths::store::{TileStore, Vertices};
use crate::paths::surface::relief::ReliefMaps;
use glam::Vec3;

/// Runs backward sweeps over a tile's store.
pub struct BackwardSweep<'a> {
    pub view: &'a SceneView<'a>,
    pub wanted: &'a Wanted,
    /// What carries the film's samples.
    pub drift: Option<&'a Drift>,
    /// What carries bounces of diffuse lobes.
    pub lobe_drift: Option<&'a LobeDrift>,
    /// Whether a pixel's filter is taken where samples move to.
    pub filter_follows: bool,
}

/// A vertex as it was, with what its adjoints need.
pub(crate) struct Solved<'a> {
    pub vertices: &'a Vertices,
    pub t: Lane,
    pub b: [Lane; 2],
    pub x: V3<Lane>,
    /// Unit shading normal on the side the ray came from.
    pub n: V3<Lane>,
    /// The same before a picture turned it.
    pub base_n: V3<Lane>,
    /// The same before it was kept above the arriving ray's horizon.
    pub raw_n: V3<Lane>,
    /// What turns it.
    pub relief: Option<ReliefMaps>,
    /// Lanes whose normal was.
    pub kept_above: u32,
    pub ids: [[u32; 3]; LANES],
    pub corners: [V3<Lane>; 3],
    pub smooth: u32,
    /// Given if any lane is more than diffuse.
    pub interface: Option<Interface<Lane>>,
    /// Given if any lane has layers or a grain, with what the grain is made of.
    pub layers: Option<(Layers<Lane>, [Lane; 2])>,
}

/// What a vertex hands to the one before it: the cotangents of the ray between them and of the
/// throughput, and those that emission found by the bounce has for the earlier vertex itself.
pub(crate) struct Returning {
    /// The derivative by the radiance of each path.
    pub radiance_bar: V3<Lane>,
    pub origin: V3<Lane>,
    pub direction: V3<Lane>,
    throughput: V3<Lane>,
    pub earlier: VertexBars,
    /// By what the scores of the earlier vertex' sample of the environment map and of the ray are
    /// multiplied.
    scored: [V3<Lane>; 2],
}

impl Returning {
    fn begin(radiance_bar: V3<Lane>) -> Self {
        let zero = V3::splat(0.0);
        Self {
            radiance_bar,
            origin: zero,
            direction: zero,
            throughput: zero,
            earlier: VertexBars::zero(),
            scored: [zero; 2],
        }
    }
}

impl BackwardSweep<'_> {
    /// Adds the gradient of Σ radiance_bar · radiance over the lanes of a packet, whose camera rays
    /// go through the film points (`u`, `v`). Returns the cotangents of these, if the film drifts.
    pub fn add_path(
        &self,
        store: &TileStore,
        packet: usize,
        at: [Lane; 2],
        radiance_bar: V3<Lane>,
        sums: &mut TileSums,
    ) -> [Lane; 2] {
        self.add_scored_path(store, packet, at, (radiance_bar, &[]), sums)
    }

    /// The same if samples move, whose scores multiply `scored` ([`SceneView::scored`]).
    pub(crate) fn add_scored_path(
        &self,
        store: &TileStore,
        packet: usize,
        [u, v]: [Lane; 2],
        (radiance_bar, scored): (V3<Lane>, &[Scored]),
        sums: &mut TileSums,
    ) -> [Lane; 2] {
        let path = store.path(packet);
        let mut next: Option<Solved> = None;
        let mut chain = Returning::begin(radiance_bar);
        for (k, vertices) in path.iter().enumerate().rev() {
            let here = next.take().or_else(|| self.solve(vertices));
            let before = k.checked_sub(1).and_then(|k| self.solve(&path[k]));
            let pair = (here.as_ref(), before.as_ref());
            if let Some([own, next]) = scored.get(k..k + 2) {
                chain.scored = [own.environment, next.radiance];
            }
            chain = self.vertex(store, vertices, pair, chain, sums);
            next = before;
        }
        if self.wanted.camera || self.drift.is_some() || store.samples_move() {
            let bits = path[0].hit | path[0].escaped;
            let camera = &self.view.camera;
            let bars = camera_ray_adjoint(camera, [u, v], chain.origin, chain.direction);
            if !self.wanted.camera {
                return bars.film;
            }
            let origin = sums.over_lanes(bars.origin, bits);
            let axes = bars.film_axes.map(|bar| sums.over_lanes(bar, bits));
            let tan = bars.tan_half_x_fov;
            let tan = sums.over_lanes(V3::new(tan, tan, tan), bits).x;
            sums.add_camera(camera, origin, axes, tan);
            return bars.film;
        }
        [Lane::splat(0.0); 2]
    }

    /// One vertex: `after` holds the cotangents that the next vertex handed back.
    fn vertex(
        &self,
        store: &TileStore,
        vertices: &Vertices,
        (here, before): (Option<&Solved>, Option<&Solved>),
        after: Returning,
        sums: &mut TileSums,
    ) -> Returning {
        let radiance_bar = after.radiance_bar;
        let mut back = Returning::begin(radiance_bar);
        if vertices.escaped != 0 {
            self.escape(vertices, before, &mut back, sums);
        }
        let relays = store.relays(vertices);
        let Some(here) = here else {
            if self.wanted.attached() {
                self.turn(relays, vertices.escaped, &mut back);
            }
            return back;
        };
        let mut bars = after.earlier;
        let turning = self.bounce(
            here,
            [after.origin, after.direction, after.throughput],
            &mut bars,
            sums,
        );
        if vertices.warped.world != 0 {
            let all = radiance_bar.times(after.scored[1]);
            let turning = TurningBars {
                direction: turning,
                score: all.x + all.y + all.z,
            };
            let follows = store.followed(vertices.warped.bounce_follows);
            let moved = (follows, vertices.local);
            self.add_turning(here, moved, &turning, &mut bars, sums);
        }
        let kept = masked(!lanes(relays), radiance_bar);
        self.arriving(store, (here, before), kept, (&mut bars, &mut back), sums);
        if !self.view.lights.is_empty() {
            self.light_sample(here, radiance_bar, &mut bars, sums);
            self.moving_light_sample(store, here, radiance_bar, &mut bars, sums);
        }
        if let Some(sample) = store.environment_sample(vertices) {
            let lit = sample.weight.gt(Lane::splat(0.0)).to_bits();
            let bar = Cotangent::of_lanes(lit, radiance_bar);
            if store.samples_move() {
                let all = radiance_bar.times(after.scored[0]);
                let bars = (bar, all.x + all.y + all.z, &mut bars);
                self.moving_environment_sample(store, (here, sample), bars, sums);
            } else {
                let sample = (sample.direction, sample.weight);
                self.environment_brings(here, sample, bar, &mut bars, sums);
            }
        }
        self.boundary(store, here, radiance_bar, &mut bars, sums);
        self.leave_vertex(here, &mut bars, &mut back, sums);
        if !relays.is_empty() {
            if self.wanted.attached() {
                self.slide(relays, here, &mut back, sums);
                self.turn(relays, vertices.escaped, &mut back);
            }
            let mut bars = VertexBars::zero();
            let relayed = masked(lanes(relays), radiance_bar);
            self.arriving(store, (here, before), relayed, (&mut bars, &mut back), sums);
            self.leave_vertex(here, &mut bars, &mut back, sums);
        }
        back
    }

    /// From a vertex's cotangents to those of the ray that arrives.
    fn leave_vertex(
        &self,
        here: &Solved,
        bars: &mut VertexBars,
        back: &mut Returning,
        sums: &mut TileSums,
    ) {
        self.slots(here, bars, sums);
        self.choice(here, bars, sums);
        back.throughput = back.throughput + masked(here.vertices.hit, bars.arriving);
        if self.wanted.attached() {
            self.surface(here, bars, back, sums);
        }
    }

    /// Where paths leave the scene.
    fn escape(
        &self,
        vertices: &Vertices,
        before: Option<&Solved>,
        back: &mut Returning,
        sums: &mut TileSums,
    ) {
        let scene = self.view.scene;
        let Some(environment) = &scene.environment else {
            return;
        };
        let radiance_bar = back.radiance_bar;
        let sampled = vertices.sampled & vertices.escaped;
        if let (Some(from), true) = (before, sampled != 0) {
            let bar = Cotangent::of_lanes(sampled, radiance_bar);
            let sample = (vertices.direction, vertices.emission_weight);
            self.environment_brings(from, sample, bar, &mut back.earlier, sums);
        }
        let seen = vertices.escaped & !sampled;
        let value = self
            .view
            .environment_radiance(environment, vertices.direction);
        back.throughput = masked(seen, radiance_bar.times(value));
        let value_bar = masked(seen, radiance_bar.times(vertices.throughput));
        let texture = environment.radiance;
        let Some(map) = &environment.map else {
            let sum = sums.over_lanes(value_bar, seen);
            sums.add_texel(self.wanted, texture, 0, sum.as_vec3());
            return;
        };
        let mut direction_bar = [Vec3::ZERO; LANES];
        for lane in (0..LANES).filter(|&l| seen >> l & 1 == 1) {
            let bar = lane_of(value_bar, lane);
            let d = lane_of(vertices.direction, lane);
            let found = map::lookup(&scene.textures[texture], map, d);
            for (&texel, weight) in found.texels.iter().zip(found.weights) {
                sums.add_texel(self.wanted, texture, texel, bar * weight);
            }
            let [u, v] = found.by_uv.map(|by| by.dot(bar));
            let turn = found.by_direction[0] * u + found.by_direction[1] * v;
            direction_bar[lane] = turn;
            if self.wanted.environment && sums.admits(turn.is_finite() && bar.is_finite()) {
                // The direction turns by −ω × d as the map sees it.
                let scale = f64::from(found.value.dot(bar) / map.scale);
                sums.add_environment(-d.cross(turn).as_dvec3(), scale);
            }
        }
        if self.wanted.attached() {
            back.direction = from_lanes(&direction_bar);
        }
    }

    /// The next ray and the next throughput, from their cotangents. Returns those of directions of
    /// the world, where bounces are such.
    fn bounce(
        &self,
        here: &Solved,
        [origin, direction, throughput]: [V3<Lane>; 3],
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        let mut turning = V3::splat(0.0);
        let alive = vertices.survival.gt(Lane::splat(0.0));
        if !alive.any() {
            return turning;
        }
        let bits = alive.to_bits() & vertices.hit;
        // T' = T·weight·survival.
        let on = masked(bits, throughput * vertices.survival);
        let weight_bar = on.times(vertices.throughput);
        bars.throughput = bars.throughput + on.times(vertices.weight);
        bars.x = bars.x + masked(bits, origin);
        let world = bits & vertices.warped.world;
        if world != 0 {
            let weight_bar = Cotangent::of_lanes(world, weight_bar);
            turning = masked(world, direction) + self.bounce_in_world(here, weight_bar, bars);
        }
        let bits = bits & !world;
        let (direction, weight_bar) = (masked(bits, direction), masked(bits, weight_bar));
        let direction = self.drift(here, direction, weight_bar, bars, sums);
        let local = vertices.local;
        let Some(interface) = &here.interface else {
            bars.interface.reflectance = bars.interface.reflectance + weight_bar;
            if self.wanted.attached() {
                let (n, _) = direction_from_local_adjoint(here.n, local, direction);
                bars.n = bars.n + masked(bits, n);
            }
            return turning;
        };
        let lanes = Cotangent::of_lanes(bits, weight_bar);
        self.bounce_off(here, interface, (direction, lanes), bars);
        turning
    }

    /// Bounces off what is more than diffuse, from the cotangents of directions and weights.
    fn bounce_off(
        &self,
        here: &Solved,
        interface: &Interface<Lane>,
        (direction, weight_bar): (V3<Lane>, Cotangent),
        bars: &mut VertexBars,
    ) {
        let (vertices, local) = (here.vertices, here.vertices.local);
        let Cotangent {
            bits,
            value: weight_bar,
        } = weight_bar;
        let rests = vertices.resting_lobes() & bits;
        let black = self.rest(here, Cotangent::of_lanes(rests, weight_bar), bars);
        let turns = bits & !rests;
        let direction = masked(turns, direction);
        let weight_bar = masked(turns, weight_bar) + black;
        let layered = vertices.kinds.layered();
        let mut weight_bar = weight_bar * vertices.inverse_density;
        let mut direction = direction;
        if vertices.kinds.relief != 0 {
            let (next, weight) = self.unhidden_bounce(here);
            let bar = Cotangent::of_lanes(bits, weight_bar);
            let (w_bar, kept) = self.shown_backward(here, (next, weight), bar, bars);
            direction = direction + w_bar;
            weight_bar = kept;
        }
        if let Some((layers, _)) = &here.layers {
            let bits = bits & layered;
            let (n, arriving, _, s, l) = layered_sample_adjoint(
                here.n,
                vertices.direction,
                local,
                *interface,
                *layers,
                vertices.lobes.masks(),
                vertices.kinds.masks(),
                (masked(bits, direction), masked(bits, weight_bar)),
            );
            bars.n = bars.n + masked(bits, n);
            bars.direction = bars.direction + masked(bits, arriving);
            bars.add_interface(bits, &s);
            bars.add_layers(bits, &l);
        }
        let bits = bits & !layered;
        let (direction, weight_bar) = (masked(bits, direction), masked(bits, weight_bar));
        let (n, arriving, _, s, _) = bsdf_sample_adjoint(
            here.n,
            vertices.direction,
            local,
            *interface,
            self.view.transmission(vertices, here.n, local.z),
            vertices.lobes.masks(),
            vertices.kinds.masks(),
            (direction, weight_bar),
        );
        bars.n = bars.n + masked(bits, n);
        bars.direction = bars.direction + masked(bits, arriving);
        bars.add_interface(bits, &s);
    }

    /// The next direction, and what the path is multiplied with but for what a turned surface hides
    /// of itself.
    pub(super) fn unhidden_bounce(&self, here: &Solved) -> (V3<Lane>, V3<Lane>) {
        let vertices = here.vertices;
        let Some(interface) = here.interface else {
            return (here.n, V3::splat(0.0));
        };
        let (lobes, kinds) = (vertices.lobes.masks(), vertices.kinds.masks());
        let (n, direction, local) = (here.n, vertices.direction, vertices.local);
        let through = self.view.transmission(vertices, n, local.z);
        let (next, weight) = bsdf_sample(n, direction, local, interface, through, lobes, kinds);
        let Some((layers, _)) = here.layers else {
            return (next, weight);
        };
        let is_layered = lane_mask(vertices.kinds.layered());
        let (own, layered) = layered_sample(n, direction, local, interface, layers, lobes, kinds);
        (
            V3::select(is_layered, own, next),
            V3::select(is_layered, layered, weight),
        )
    }

    /// From the cotangent of what is sent toward or from `w` to those of `w` and of what would be
    /// sent if nothing hid it, `value`.
    pub(crate) fn shown_backward(
        &self,
        here: &Solved,
        (w, value): (V3<Lane>, V3<Lane>),
        bar: Cotangent,
        bars: &mut VertexBars,
    ) -> (V3<Lane>, V3<Lane>) {
        let relief = here.vertices.kinds.relief & bar.bits;
        if relief == 0 {
            return (V3::splat(0.0), bar.value);
        }
        let shown = relief_shadow(here.base_n, here.n, w);
        let shown_bar = masked(relief, bar.value).dot(value);
        let (base_n, n, w_bar) = relief_shadow_adjoint(here.base_n, here.n, w, shown_bar);
        bars.base_n = bars.base_n + masked(relief, base_n);
        bars.n = bars.n + masked(relief, n);
        let kept = V3::select(lane_mask(relief), bar.value * shown, bar.value);
        (masked(relief, w_bar), kept)
    }
}
