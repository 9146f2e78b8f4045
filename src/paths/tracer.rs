//! Tracing paths, one packet of lanes at a time: camera ray, light sample, bounce, and so on.
//!
//! What is drawn and how it is weighed is in `paths::direct` and `paths::bounce`.

use super::beside::Bends;
use super::bounce_cells::{self, Seen};
use super::camera::{Camera, splat};
use super::lights::Lights;
use super::materials::MaterialTable;
use super::moving::Moving;
use super::random::Stream;
use super::rays::{RayPacket, to_rays};
use super::sky::Sky;
use super::store::{TileStore, Vertices, lane_mask, masked};
use super::surface::Surface;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::scene::Scene;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use crate::trace::{Accel, Coherence, Hits, MISS, Rays};
use crate::warp::adjacency::Adjacency;
use glam::Vec3;

/// Pairs of random numbers that a vertex consumes.
pub const PAIRS_PER_VERTEX: u32 = 5;

/// What limits a path.
#[derive(Clone, Copy, Debug)]
pub struct PathLimits {
    pub max_depth: u32,
    pub rr_depth: u32,
    pub hide_emitters: bool,
    /// Paths go on from black surfaces: someone asks what would change if they reflected.
    pub black_goes_on: bool,
}

/// What was done: rays traced by kind, and silhouettes that could not be found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub camera: u64,
    pub shadow: u64,
    pub bounce: u64,
    /// Shadow rays to a light's rim: they only find silhouettes.
    pub light_cell: u64,
    /// Rays along the horizon and beside it: they only find silhouettes.
    pub bounce_cell: u64,
    /// Rays to the environment map: they only find silhouettes.
    pub sky_cell: u64,
    /// Rays that look for and beside silhouettes, and those of the paths that go on from there.
    pub probe: u64,
    /// Cells between whose ends a silhouette was found.
    pub resolved: u64,
    /// Cells whose ends differ though no silhouette was found between them.
    pub unresolved: u64,
    /// Samples of the image left out because they were not finite.
    pub not_finite: u64,
    /// Borders left out because what jumps there was not finite.
    pub boundary_not_finite: u64,
    /// Terms of the gradient left out because they were not finite.
    pub gradient_not_finite: u64,
}

impl Counts {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera
            + self.shadow
            + self.bounce
            + self.light_cell
            + self.bounce_cell
            + self.sky_cell
            + self.probe
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, o: Self) {
        self.camera += o.camera;
        self.shadow += o.shadow;
        self.bounce += o.bounce;
        self.light_cell += o.light_cell;
        self.bounce_cell += o.bounce_cell;
        self.sky_cell += o.sky_cell;
        self.probe += o.probe;
        self.resolved += o.resolved;
        self.unresolved += o.unresolved;
        self.not_finite += o.not_finite;
        self.boundary_not_finite += o.boundary_not_finite;
        self.gradient_not_finite += o.gradient_not_finite;
    }
}

/// Everything a path needs to know of the scene.
pub struct Tracer<'a> {
    pub scene: &'a Scene,
    pub geometry: &'a Geometry,
    pub accel: &'a Accel,
    pub lights: &'a Lights,
    pub materials: &'a MaterialTable,
    /// Given if there is an environment map.
    pub sky: Option<&'a Sky>,
    pub camera: Camera,
    pub limits: PathLimits,
    /// Given if silhouettes are wanted, because something moves.
    pub adjacency: Option<&'a Adjacency>,
    /// What moves, of what there are silhouettes of.
    pub moving: &'a Moving,
}

impl Tracer<'_> {
    /// Traces the paths that begin with `rays` at vertex `depth` (0: the camera's) and appends their vertices.
    pub fn trace(
        &self,
        rays: RayPacket,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
        store: &mut TileStore,
    ) {
        self.trace_vertices(rays, 0, true, 0, stream, index, counts, store);
        store.depths.push(store.vertices.len() as u32);
    }

    /// Appends vertices from number `first_depth` on. `bends`: lanes beside edges at which only the plane bends ([`Bends`]); none if the
    /// paths are to be differentiated.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn trace_vertices(
        &self,
        mut rays: RayPacket,
        first_depth: u32,
        with_emission: bool,
        bends: u32,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
        store: &mut TileStore,
    ) {
        let mut coherence = Coherence::Coherent;
        let mut throughput = V3::splat(1.0);
        // What a probe's first ray finds emitting counts where the path it stands for would count it.
        let first_weight = if (first_depth == 0 && self.limits.hide_emitters) || !with_emission {
            0.0
        } else {
            1.0
        };
        let mut previous: Option<Surface> = None;
        let mut rim = Lane::splat(1.0);
        let mut moves = self.moving.camera_lanes();
        for depth in first_depth.. {
            let triangle = self.intersect(&rays, coherence);
            *if depth == 0 {
                &mut counts.camera
            } else {
                &mut counts.bounce
            } += rays.active.count_ones() as u64;
            if let (Some(adjacency), Some(from)) = (self.adjacency, &previous) {
                let seen = Seen::Triangles(&triangle);
                bounce_cells::find(
                    self, adjacency, from, &rays, seen, depth, stream, index, counts, store,
                );
            }
            let mut vertices = Vertices {
                origin: rays.origin,
                direction: rays.direction,
                triangle,
                throughput,
                emission_weight: Lane::splat(first_weight),
                ..Vertices::default()
            };
            if self.adjacency.is_some() {
                moves |= self.moving.lanes(self.geometry, &triangle);
                vertices.moves = moves;
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
            if depth == 0 && self.limits.hide_emitters {
                vertices.escaped = 0;
            }
            if depth > 0 && depth == first_depth && self.sky.is_some() && !with_emission {
                // Wide lobes see the map by lines of its own.
                vertices.escaped = 0;
            }
            let surface = self.surface(&mut vertices);
            if let (Some(previous), Some(from)) = (&previous, store.vertices.last()) {
                self.weigh_emission(&mut vertices, from, previous, rim);
            }

            let segments = depth + 2;
            if vertices.hit != 0 && segments <= self.limits.max_depth {
                let goes_on = segments < self.limits.max_depth;
                let has_lights = !self.lights.is_empty();
                // Lights are seen in narrow lobes only along bounces.
                let narrow = vertices.hit & vertices.kinds.seen_along_bounces();
                let looks_for_light = has_lights && narrow != 0;
                let bounces = goes_on || self.scene.environment.is_some() || looks_for_light;
                let base = depth * PAIRS_PER_VERTEX;
                if has_lights {
                    self.sample_lights(
                        &mut vertices,
                        &surface,
                        stream,
                        index,
                        base,
                        bounces,
                        counts,
                        store,
                    );
                }
                if let Some(sky) = self.sky {
                    self.sample_sky(
                        sky,
                        &mut vertices,
                        &surface,
                        stream,
                        index,
                        depth,
                        counts,
                        store,
                    );
                }
                if !self.scene.delta_lights.is_empty() {
                    self.see_delta_lights(&mut vertices, &surface, counts, store);
                }
                let bends =
                    (bends != 0 && depth == first_depth).then(|| Bends::new(bends, &surface));
                rim = Lane::splat(1.0);
                if let Some(bends) = &bends {
                    self.keep_between(bends, &mut vertices, &surface, store);
                    rim = bends.rim(&vertices, &surface);
                }
                if bounces {
                    let (next, mut alive) =
                        self.bounce(&mut vertices, &surface, rim, stream, index, depth);
                    if let Some(bends) = &bends {
                        alive &= bends.count(next.direction);
                    }
                    rays = RayPacket {
                        active: alive,
                        ..next
                    };
                    throughput = throughput.times(vertices.weight) * (vertices.survival * rim);
                    coherence = Coherence::Incoherent;
                    let last = !goes_on;
                    let looks = vertices.line_survival.gt(Lane::splat(0.0)).to_bits() != 0;
                    store.vertices.push(vertices);
                    if alive == 0 {
                        if let (Some(adjacency), true) = (self.adjacency, looks) {
                            let seen = Seen::Triangles(&[NO_TRIANGLE; LANES]);
                            let depth = depth + 1;
                            bounce_cells::find(
                                self, adjacency, &surface, &rays, seen, depth, stream, index,
                                counts, store,
                            );
                        }
                        return;
                    }
                    if last && !has_lights {
                        // Only whether the environment is seen matters: any hit will do.
                        let mut end = self.last_bounce(&rays, throughput, counts);
                        if let Some(from) = store.vertices.last() {
                            self.weigh_emission(&mut end, from, &surface, rim);
                        }
                        if let Some(adjacency) = self.adjacency {
                            let sees = Seen::Environment(end.escaped);
                            bounce_cells::find(
                                self,
                                adjacency,
                                &surface,
                                &rays,
                                sees,
                                depth + 1,
                                stream,
                                index,
                                counts,
                                store,
                            );
                        }
                        store.vertices.push(end);
                        return;
                    }
                    previous = Some(surface);
                    continue;
                }
            }
            store.vertices.push(vertices);
            return;
        }
    }

    /// Emission found by a bounce counts fully in narrow lobes; in others it shares with light samples.
    fn weigh_emission(
        &self,
        vertices: &mut Vertices,
        from: &Vertices,
        surface: &Surface,
        rim: Lane,
    ) {
        let drawn = from.lobes.diffuse | (from.lobes.reflected & from.kinds.wide);
        let one = Lane::splat(1.0);
        vertices.emission_weight = one;
        if !self.lights.is_empty() && vertices.hit != 0 {
            vertices.sampled = drawn & vertices.hit;
            let (weight, value) = self.sampled_emission(vertices, from, surface);
            let sampled = lane_mask(vertices.sampled);
            vertices.emission_weight = <Lane as Real>::select(sampled, weight, one);
            vertices.sampled_value = value * rim;
        }
        let escaped = drawn & vertices.escaped;
        if let (Some(sky), true) = (self.sky, escaped != 0) {
            let (weight, value) = self.sampled_sky(sky, vertices, from, surface, escaped);
            let lanes = lane_mask(escaped);
            vertices.sampled |= escaped;
            vertices.emission_weight =
                <Lane as Real>::select(lanes, weight, vertices.emission_weight);
            vertices.sampled_value = V3::select(lanes, value * rim, vertices.sampled_value);
        }
    }

    /// The vertices of a bounce of which only the escape counts.
    fn last_bounce(&self, rays: &RayPacket, throughput: V3<Lane>, counts: &mut Counts) -> Vertices {
        counts.bounce += rays.active.count_ones() as u64;
        let blocked = self
            .accel
            .occluded(&to_rays(rays), rays.active, Coherence::Incoherent);
        Vertices {
            origin: rays.origin,
            direction: rays.direction,
            throughput,
            escaped: rays.active & !blocked,
            ..Vertices::default()
        }
    }

    /// The triangle each ray meets first.
    pub fn intersect(&self, rays: &RayPacket, coherence: Coherence) -> [u32; LANES] {
        let mut hits = Hits::<LANES>::default();
        self.accel
            .intersect(&to_rays(rays), rays.active, &mut hits, coherence);
        std::array::from_fn(|l| {
            if rays.active >> l & 1 == 1 && hits.mesh[l] != MISS {
                self.geometry.first_triangle[hits.mesh[l] as usize] + hits.triangle[l]
            } else {
                NO_TRIANGLE
            }
        })
    }

    /// The triangle one ray meets first.
    pub fn first_hit(&self, origin: Vec3, direction: Vec3, near: f32, far: f32) -> u32 {
        let mut ray = Rays::<1>::default();
        ray.set(0, origin, direction, near, far);
        let mut hit = Hits::<1>::default();
        self.accel
            .intersect(&ray, 1, &mut hit, Coherence::Incoherent);
        match hit.mesh[0] {
            MISS => NO_TRIANGLE,
            mesh => self.geometry.first_triangle[mesh as usize] + hit.triangle[0],
        }
    }

    /// Radiance of each path of `store` that begins at `path`: Σ over vertices of throughput · (emission + light samples).
    pub fn radiance(&self, store: &TileStore, path: &[Vertices]) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        let mut previous: Option<&Vertices> = None;
        for vertices in path {
            sum = sum + self.arriving(vertices, previous);
            if vertices.hit != 0 {
                if !self.lights.is_empty() {
                    sum = sum + vertices.throughput.times(self.sampled_light(vertices));
                }
                if let (Some(sample), Some(environment)) =
                    (store.sky_sample(vertices), &self.scene.environment)
                {
                    let light = self.sky_light(environment, sample);
                    sum = sum + vertices.throughput.times(light);
                }
                let [from, to] = vertices.delta_lights.map(|i| i as usize);
                if from != to {
                    let surface = self.surface(&mut vertices.clone());
                    let light =
                        self.delta_light(vertices, &surface, &store.delta_visible[from..to]);
                    sum = sum + vertices.throughput.times(light);
                }
            }
            previous = Some(vertices);
        }
        sum
    }

    /// What the arriving rays found emitting, throughput and all.
    fn arriving(&self, vertices: &Vertices, from: Option<&Vertices>) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        if !self.lights.is_empty() && vertices.hit != 0 {
            let emitted = self.emission(vertices) * vertices.emission_weight;
            let mut found = vertices.throughput.times(emitted);
            if let (Some(from), true) = (from, vertices.sampled != 0) {
                let sampled = from.throughput.times(vertices.sampled_value);
                found = V3::select(lane_mask(vertices.sampled), sampled.times(emitted), found);
            }
            sum = masked(vertices.hit, found);
        }
        if let (Some(environment), true) = (&self.scene.environment, vertices.escaped != 0) {
            let radiance = self.environment_radiance(environment, vertices.direction);
            let mut found = vertices.throughput.times(radiance);
            let sampled = vertices.sampled & vertices.escaped;
            if let (Some(from), true) = (from, sampled != 0) {
                let brings = from.throughput.times(vertices.sampled_value);
                let brings = brings.times(radiance) * vertices.emission_weight;
                found = V3::select(lane_mask(sampled), brings, found);
            }
            sum = sum + masked(vertices.escaped, found);
        }
        sum
    }

    /// Radiance of the environment along `direction`.
    pub fn environment_radiance(
        &self,
        environment: &crate::scene::Environment,
        direction: V3<Lane>,
    ) -> V3<Lane> {
        match &environment.map {
            None => splat(Vec3::from(self.scene.constant(environment.radiance))),
            Some(map) => {
                let texture = &self.scene.textures[environment.radiance];
                super::environment::radiance(texture, map, direction)
            }
        }
    }
}
