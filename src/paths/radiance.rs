//! From stored vertices to the radiance of paths.

use crate::lanes::{Lane, V3};
use crate::paths::environment::map;
use crate::paths::rays::{lane_mask, masked, splat};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{TileStore, Vertices};
use crate::scene::Environment;
use glam::Vec3;

/// By what scores at a vertex are multiplied (`paths::warp`).
#[derive(Clone, Copy, Debug)]
pub struct Scored {
    /// That of the ray that arrives: the radiance of this vertex and all after it.
    pub radiance: V3<Lane>,
    /// That of the sample of the environment map.
    pub environment: V3<Lane>,
}

impl Scored {
    pub fn none() -> Self {
        Self {
            radiance: V3::splat(0.0),
            environment: V3::splat(0.0),
        }
    }
}

impl SceneView<'_> {
    /// Radiance of each path of `store` that begins at `path`: Σ over vertices of throughput ·
    /// (emission + light samples).
    pub fn radiance(&self, store: &TileStore, path: &[Vertices]) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        let mut previous: Option<&Vertices> = None;
        for vertices in path {
            sum = sum + self.brings(store, vertices, previous);
            previous = Some(vertices);
        }
        sum
    }

    /// By what the scores of a path's samples are multiplied, by vertices: what those bring, less
    /// what the twin's bring.
    pub fn scored(&self, store: &TileStore, path: usize) -> Vec<Scored> {
        let mut scored = self.scored_alone(store, store.path(path));
        if let Some(twin) = store.twin(path) {
            let others = self.scored_alone(store, store.path(twin));
            for (own, other) in scored.iter_mut().zip(others) {
                own.radiance = own.radiance - other.radiance;
                own.environment = own.environment - other.environment;
            }
        }
        scored
    }

    fn scored_alone(&self, store: &TileStore, path: &[Vertices]) -> Vec<Scored> {
        let mut scored = vec![Scored::none(); path.len() + 1];
        for (k, vertices) in path.iter().enumerate().rev() {
            let previous = k.checked_sub(1).map(|k| &path[k]);
            let after = scored[k + 1].radiance;
            scored[k] = Scored {
                radiance: after + self.brings(store, vertices, previous),
                environment: match vertices.hit {
                    0 => V3::splat(0.0),
                    _ => self.brings_from_map(store, vertices),
                },
            };
        }
        scored
    }

    /// What one vertex brings to the radiance of its path.
    fn brings(
        &self,
        store: &TileStore,
        vertices: &Vertices,
        previous: Option<&Vertices>,
    ) -> V3<Lane> {
        let mut sum = self.arriving(vertices, previous);
        if vertices.hit == 0 {
            return sum;
        }
        if !self.lights.is_empty() {
            sum = sum + vertices.throughput.times(self.sampled_light(vertices));
        }
        sum = sum + self.brings_from_map(store, vertices);
        let visible = store.delta_visible(vertices);
        if !visible.is_empty() {
            let surface = self.surface(&mut vertices.clone());
            let light = self.delta_light(vertices, &surface, visible);
            sum = sum + vertices.throughput.times(light);
        }
        sum
    }

    /// What a vertex's sample of the environment map brings.
    fn brings_from_map(&self, store: &TileStore, vertices: &Vertices) -> V3<Lane> {
        match (store.environment_sample(vertices), &self.scene.environment) {
            (Some(sample), Some(environment)) => {
                let light = self.environment_light(environment, sample);
                vertices.throughput.times(light)
            }
            _ => V3::splat(0.0),
        }
    }

    /// What the arriving rays found emitting, throughput and all.
    fn arriving(&self, vertices: &Vertices, from: Option<&Vertices>) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        if !self.lights.is_empty() && vertices.hit != 0 {
            let emitted = self.emission(vertices) * vertices.emission_weight;
            let mut found = vertices.arriving_throughput().times(emitted);
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
    pub fn environment_radiance(&self, environment: &Environment, direction: V3<Lane>) -> V3<Lane> {
        match &environment.map {
            None => splat(Vec3::from(self.scene.constant(environment.radiance))),
            Some(map) => {
                let texture = &self.scene.textures[environment.radiance];
                map::radiance(texture, map, direction)
            }
        }
    }
}
