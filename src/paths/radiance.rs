//! From stored vertices to the radiance of paths.

use crate::lanes::{Lane, V3};
use crate::paths::environment::map;
use crate::paths::rays::{lane_mask, masked, splat};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{TileStore, Vertices};
use crate::scene::Environment;
use glam::Vec3;

impl SceneView<'_> {
    /// Radiance of each path of `store` that begins at `path`: Σ over vertices of throughput ·
    /// (emission + light samples).
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
                    (store.environment_sample(vertices), &self.scene.environment)
                {
                    let light = self.environment_light(environment, sample);
                    sum = sum + vertices.throughput.times(light);
                }
                let visible = store.delta_visible(vertices);
                if !visible.is_empty() {
                    let surface = self.surface(&mut vertices.clone());
                    let light = self.delta_light(vertices, &surface, visible);
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
