//! Tracing paths, one packet of lanes at a time: camera ray, light samples, bounce, and so on.
//!
//! `paths::light`, `paths::environment` and `paths::surface` draw and weigh. Wherever an integral
//! is estimated whose integrand may jump, the boundary estimator is called (`paths::estimator`).

use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::at::{At, Numbers};
use crate::paths::between_planes::BetweenPlanes;
use crate::paths::bounce::{Bounce, BounceEnd};
use crate::paths::estimator::{BoundaryEstimator, Interior};
use crate::paths::film::drift::Drift;
use crate::paths::film::edge_on::EdgeOnFacets;
use crate::paths::random::Stream;
use crate::paths::rays::{RayPacket, lane_mask};
use crate::paths::scene_view::SceneView;
use crate::paths::spread::Spread;
use crate::paths::start::{Path, Start};
use crate::paths::store::{TileStore, Vertices};
use crate::paths::surface::vertex::Surface;
use crate::paths::warp::seam::{MapSamples, Warp, WarpedBounce};
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;

/// Traces and stores paths, and has an estimator find what jumps along them.
#[derive(Clone, Copy)]
pub struct Integrator<'a> {
    pub view: &'a SceneView<'a>,
    pub estimator: &'a dyn BoundaryEstimator,
    /// What carries the film's samples.
    pub drift: Option<&'a Drift>,
    /// What has samples of its own on the film.
    pub edge_on: Option<&'a EdgeOnFacets>,
    /// Which of two paths that share their random numbers but those of kernels.
    pub twin: u32,
}

impl Integrator<'_> {
    /// Traces the paths that begin with a packet of camera rays and appends their vertices.
    pub fn trace_from_camera(
        &self,
        rays: RayPacket,
        drifts: u32,
        stream: &Stream,
        index: &[u32; LANES],
        store: &mut TileStore,
    ) {
        let start = Start {
            drifts,
            ..Start::of_rays(rays, 0)
        };
        self.trace(&start, stream, index, store);
        store.depths.push(store.vertices.len() as u32);
    }

    /// Traces paths and appends their vertices.
    pub fn trace(
        &self,
        start: &Start,
        stream: &Stream,
        index: &[u32; LANES],
        store: &mut TileStore,
    ) {
        let moving = self.estimator.moving();
        let mut path = Path {
            rays: start.rays,
            coherence: Coherence::Coherent,
            throughput: start.throughput,
            spread: moving.map(|_| Spread::new(&self.view.camera)),
            moves: start.drifts | moving.map_or(0, |m| m.camera_lanes()),
            previous: None,
            drawn: None,
        };
        for depth in start.depth.. {
            let numbers = Numbers {
                stream,
                index,
                depth,
            };
            let mut vertices = self.arrive(start, &mut path, depth, store);
            let before = Numbers {
                depth: depth.wrapping_sub(1),
                ..numbers
            };
            let seen = BounceEnd::Triangles(&vertices.triangle);
            self.look_over_lobe(&path, seen, before, store);
            self.view.choose(&mut vertices, &numbers);
            let surface = self.view.surface(&mut vertices);
            surface.count_turned_round(self.view, &vertices, &mut store.counts);
            self.mis_weigh_emission(&mut vertices, &path, store);
            self.relay(&mut path, (&mut vertices, &surface), numbers, store);
            let segments = depth + 2;
            if vertices.hit == 0 || segments > self.view.limits.max_depth {
                store.vertices.push(vertices);
                return;
            }
            let bounces = self.bounces(&vertices, segments);
            self.next_event_estimation(&mut vertices, &surface, &numbers, bounces, store);
            if depth == start.depth && !start.with_delta_lights {
                vertices.delta_lights = [0; 2];
            }
            let between = (start.between_planes != 0 && depth == start.depth)
                .then(|| BetweenPlanes::new(start.between_planes, &surface));
            if let Some(between) = &between {
                // On the film they have a search of their own.
                let with_delta_lights = depth > 0;
                self.view
                    .keep_between(between, &mut vertices, &surface, with_delta_lights, store);
            }
            if !bounces {
                store.vertices.push(vertices);
                return;
            }
            let rim = match &between {
                Some(between) => between.rim(&vertices, &surface),
                None => Lane::splat(1.0),
            };
            let here = (&surface, rim);
            self.leave(&mut path, &mut vertices, here, &between, &numbers);
            // Both are large: each is moved once.
            path.previous = Some((surface, rim));
            store.vertices.push(vertices);
            if self.ends(&mut path, segments, numbers, store) {
                return;
            }
        }
    }

    /// Follows the rays to the next vertex.
    fn arrive(
        &self,
        start: &Start,
        path: &mut Path,
        depth: u32,
        store: &mut TileStore,
    ) -> Vertices {
        let view = self.view;
        let rays = &path.rays;
        let triangle = match start.seen {
            Some(seen) if depth == start.depth => seen,
            _ => {
                *if depth == 0 {
                    &mut store.counts.camera
                } else {
                    &mut store.counts.bounce
                } += rays.active.count_ones() as u64;
                view.intersect(rays, path.coherence)
            }
        };
        // What a probe's first ray finds emitting counts where the path it stands for would count
        // it.
        let hides_emission =
            (start.depth == 0 && view.limits.hide_emitters) || !start.with_emission;
        let mut vertices = Vertices {
            origin: rays.origin,
            direction: rays.direction,
            triangle,
            throughput: path.throughput,
            emission_weight: Lane::splat(if hides_emission { 0.0 } else { 1.0 }),
            ..Vertices::default()
        };
        if let Some(moving) = self.estimator.moving() {
            path.moves |= moving.lanes(view.geometry, &triangle);
            vertices.moves = path.moves;
        }
        for (lane, &t) in triangle.iter().enumerate() {
            if rays.active >> lane & 1 == 1 {
                *(if t == NO_TRIANGLE {
                    &mut vertices.escaped
                } else {
                    &mut vertices.hit
                }) |= 1 << lane;
            }
        }
        if depth == 0 && view.limits.hide_emitters {
            vertices.escaped = 0;
        }
        if depth > 0
            && depth == start.depth
            && view.map_distribution.is_some()
            && !start.with_emission
        {
            // Wide lobes see the map by lines of its own.
            vertices.escaped = 0;
        }
        vertices
    }

    /// Finds relays among the lanes of a vertex, if an estimator wants to know what moves.
    fn relay(
        &self,
        path: &mut Path,
        (vertices, surface): (&mut Vertices, &Surface),
        numbers: Numbers,
        store: &mut TileStore,
    ) {
        let Some(spread) = &mut path.spread else {
            return;
        };
        let alone = Integrator {
            estimator: &Interior,
            drift: None,
            edge_on: None,
            ..*self
        };
        let trace = |start: &Start, index: &[u32; LANES], own: &mut TileStore| {
            alone.trace(start, numbers.stream, index, own);
        };
        let at = (vertices, surface, numbers);
        self.view.relay(spread, at, &trace, store);
    }

    /// Whether any path of the packet goes on, or at least looks for light once more.
    fn bounces(&self, vertices: &Vertices, segments: u32) -> bool {
        let view = self.view;
        // Lights are seen in narrow lobes only along bounces.
        let narrow = vertices.hit & vertices.kinds.seen_along_bounces();
        let looks_for_light = !view.lights.is_empty() && narrow != 0;
        segments < view.limits.max_depth || view.scene.environment.is_some() || looks_for_light
    }

    /// Samples of all lights, and what jumps in the integrals that they estimate.
    fn next_event_estimation(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        numbers: &Numbers,
        bounces: bool,
        store: &mut TileStore,
    ) {
        let view = self.view;
        let warp = self.estimator.warp();
        let first = store.found.samples.len() as u32;
        if !view.lights.is_empty() {
            let at = At {
                view,
                vertices,
                surface,
                numbers: *numbers,
            };
            // Samples that move each in their own way share nothing.
            let shared = bounces && warp.is_none();
            let (light, draw) = at.sample_light(shared, &mut store.counts);
            self.estimator.search_light(&at, &draw, &mut store.found);
            vertices.light = light;
            if let Some(warp) = warp {
                self.follow_light(warp, vertices, surface, numbers, store);
            }
        }
        if let Some(distribution) = view.map_distribution {
            let at = At {
                view,
                vertices,
                surface,
                numbers: *numbers,
            };
            let moved = warp.map(|warp| (warp.environment_kernel(), self.twin));
            let (sample, axis) = at.sample_environment(distribution, moved, &mut store.counts);
            self.estimator.search_environment(&at, &mut store.found);
            let first_follow = store.follows.len() as u32;
            if let Some(warp) = warp {
                let samples = MapSamples {
                    at: &at,
                    direction: sample.direction,
                    axis,
                    active: sample.drawn(),
                    seen: sample.weight.gt(Lane::splat(0.0)).to_bits(),
                };
                warp.environment(&samples, &mut store.follows, &mut store.counts);
            }
            let follows = [first_follow, store.follows.len() as u32];
            vertices.warped.environment_follows = follows;
            let place = store.environment_samples.len() as u32;
            store.environment_samples.push(sample);
            vertices.environment = [place, place + 1];
        }
        if !view.delta_lights.is_empty() {
            view.see_delta_lights(vertices, surface, store);
        }
        vertices.boundary = [first, store.found.samples.len() as u32];
    }

    /// Has light samples move.
    fn follow_light(
        &self,
        warp: &dyn Warp,
        vertices: &mut Vertices,
        surface: &Surface,
        numbers: &Numbers,
        store: &mut TileStore,
    ) {
        let at = At {
            view: self.view,
            vertices,
            surface,
            numbers: *numbers,
        };
        let first = store.follows.len() as u32;
        let lanes = warp.light(&at, &mut store.follows, &mut store.counts);
        vertices.warped.light = lanes;
        vertices.warped.light_follows = [first, store.follows.len() as u32];
    }

    /// Draws where the paths go on.
    fn leave(
        &self,
        path: &mut Path,
        vertices: &mut Vertices,
        (surface, rim): (&Surface, Lane),
        between: &Option<BetweenPlanes>,
        numbers: &Numbers,
    ) {
        let mut next = self.view.bsdf_sample(vertices, surface, rim, numbers);
        path.drawn = self.estimator.warp().map(|warp| {
            let kernel = (warp.lobe_kernel(), self.twin);
            self.view
                .bounce_in_world(vertices, surface, &mut next, kernel, numbers)
        });
        if let Some(between) = between {
            next.active &= between.count(next.direction);
        }
        if let Some(drift) = self.estimator.lobe_drift(self.view) {
            let at_last = numbers.depth + 2 >= self.view.limits.max_depth;
            let to = (surface, next.direction);
            path.moves |= self.view.carry(drift, vertices, to, at_last);
        }
        if let Some(spread) = &mut path.spread {
            spread.leave(vertices);
        }
        path.rays = next;
        path.throughput = vertices.throughput.times(vertices.weight) * (vertices.survival * rim);
        path.coherence = Coherence::Incoherent;
    }

    /// Whether the paths that have left a vertex need not be followed to another; then what jumps
    /// in its lobes is found here.
    fn ends(
        &self,
        path: &mut Path,
        segments: u32,
        numbers: Numbers,
        store: &mut TileStore,
    ) -> bool {
        if path.rays.active == 0 {
            if store.vertices.last().is_some_and(Vertices::looks) {
                let seen = BounceEnd::Triangles(&[NO_TRIANGLE; LANES]);
                self.look_over_lobe(path, seen, numbers, store);
            }
            return true;
        }
        let (view, lights) = (self.view, self.view.lights);
        let asks = !lights.is_empty() && self.estimator.asks_what_bounces_meet();
        if segments < view.limits.max_depth || asks || !lights.are_few() {
            return false;
        }
        let mut end = view.ends(&path.rays, path.throughput, &mut store.counts.bounce);
        end.moves = path.moves;
        self.mis_weigh_emission(&mut end, path, store);
        if let Some(spread) = &path.spread {
            view.relay_escaped(spread, &mut end, store);
        }
        self.look_over_lobe(path, BounceEnd::Environment(end.escaped), numbers, store);
        store.vertices.push(end);
        true
    }

    /// Has the estimator find what jumps over the lobes of the vertex stored last, whose bounces
    /// have been traced.
    fn look_over_lobe(
        &self,
        path: &Path,
        seen: BounceEnd,
        numbers: Numbers,
        store: &mut TileStore,
    ) {
        let TileStore {
            vertices,
            found,
            follows,
            counts,
            ..
        } = store;
        let (Some((surface, _)), Some(vertices)) = (&path.previous, vertices.last_mut()) else {
            return;
        };
        let first_follow = follows.len() as u32;
        let at = At {
            view: self.view,
            vertices,
            surface,
            numbers,
        };
        let bounce = Bounce {
            rays: &path.rays,
            seen,
        };
        self.estimator.search_lobe(&at, &bounce, found);
        if let (Some(warp), Some(drawn)) = (self.estimator.warp(), &path.drawn) {
            let bounce = WarpedBounce {
                bounce,
                axis: drawn.axis,
                convolved: drawn.convolved,
                twin: self.twin,
            };
            warp.bounce(&at, &bounce, follows, counts);
        }
        vertices.warped.bounce_follows = [first_follow, follows.len() as u32];
        vertices.boundary[1] = found.samples.len() as u32;
    }

    /// Emission found by a bounce counts fully in narrow lobes; in others it shares with light
    /// samples.
    fn mis_weigh_emission(&self, vertices: &mut Vertices, path: &Path, store: &TileStore) {
        let (Some((surface, rim)), Some(from)) = (&path.previous, store.vertices.last()) else {
            return;
        };
        let view = self.view;
        let drawn = from.shares_lights();
        let one = Lane::splat(1.0);
        vertices.emission_weight = one;
        if self.estimator.warp().is_some() {
            // Nor do bounces share what light samples bring.
            let hit = if view.lights.is_empty() {
                0
            } else {
                vertices.hit
            };
            let map = view.map_distribution.map_or(0, |_| vertices.escaped);
            let left_out = lane_mask(drawn & (hit | map));
            vertices.emission_weight = <Lane as Real>::select(left_out, Lane::splat(0.0), one);
            vertices.escaped &= !(drawn & map);
            return;
        }
        if !view.lights.is_empty() && vertices.hit != 0 {
            vertices.sampled = drawn & vertices.hit;
            let (weight, value) = view.sampled_emission(vertices, from, surface);
            let sampled = lane_mask(vertices.sampled);
            vertices.emission_weight = <Lane as Real>::select(sampled, weight, one);
            vertices.sampled_value = value * *rim;
        }
        let escaped = drawn & vertices.escaped;
        if let (Some(distribution), true) = (view.map_distribution, escaped != 0) {
            let (weight, value) = view.sampled_environment(distribution, vertices, from, surface);
            let lanes = lane_mask(escaped);
            vertices.sampled |= escaped;
            vertices.emission_weight =
                <Lane as Real>::select(lanes, weight, vertices.emission_weight);
            vertices.sampled_value = V3::select(lanes, value * *rim, vertices.sampled_value);
        }
    }
}
