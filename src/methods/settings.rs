//! What to render with.

use super::estimators::{Constants, Method};
use super::groups::{equal_groups, group_count};
use super::noise_map::NoiseMap;
use crate::picture::Image;
use crate::scene::{Lens, Sensor};
use crate::trace::Backend;
use std::sync::Arc;

/// Samples of a group, and groups, behind the gradient of what moves before a lens with an extent.
/// Groups are the points of the lens that each tile looks through; but each keeps sums for all
/// parameters.
const LENS_SAMPLES: u32 = 4;
const LENS_GROUPS: [u32; 2] = [16, 64];

/// What to render with, the scene's own settings already filled in.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Camera paths per pixel.
    pub spp: u32,
    pub seed: u64,
    pub threads: usize,
    /// Longest path in segments; `u32::MAX` for no limit.
    pub max_depth: u32,
    /// First segment at which russian roulette may end a path.
    pub rr_depth: u32,
    /// Emitters seen directly by the camera are black.
    pub hide_emitters: bool,
    /// Index into [`Scene::sensors`](crate::scene::Scene::sensors).
    pub sensor: usize,
    /// Width and height in pixels in place of the film's.
    pub resolution: Option<[u32; 2]>,
    pub method: Method,
    pub constants: Constants,
    /// Only this part of the film, in many small tiles, in place of all: for pilots.
    pub part_of_film: Option<f64>,
    /// Whether to tell what was done in each tile: for pilots.
    pub counts_tiles: bool,
    /// Where the gradient's noise lies, so that samples are spent there; evenly, if not known.
    pub noise: Option<Arc<NoiseMap>>,
    /// What traces the rays.
    pub backend: Backend,
    /// Whether to estimate standard errors, which costs memory.
    pub standard_error: bool,
    /// In place of the groups that standard errors need.
    pub groups: Option<Groups>,
}

/// How the samples are parted into independent groups, each with a lattice and random numbers of
/// its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Groups {
    /// Divides the number of samples a pixel.
    pub count: u32,
    /// The one group to do, if not all are: the others are done elsewhere.
    pub only: Option<u32>,
}

impl Settings {
    /// Whether it is still open what `auto` does.
    pub fn needs_pilot(&self) -> bool {
        self.method.asks_a_pilot() && !self.is_decided()
    }

    /// Whether `auto` has come to what is to be done. Then differences are taken only where
    /// something moves edges.
    pub fn is_decided(&self) -> bool {
        self.constants.mixture.is_some()
    }

    /// Those of an objective's gradient: what is known of noise counts by the objective's
    /// derivative.
    pub fn weighted_by(&self, adjoint: &Image) -> Self {
        let noise = self.noise.as_ref().map(|noise| noise.weighted(adjoint));
        Self {
            noise: noise.map(Arc::new),
            ..self.clone()
        }
    }

    /// Those of a gradient of what moves: where the lens has an extent each tile of each group
    /// looks through one point of it, so there are more groups, unless someone else has parted the
    /// samples.
    pub fn through_lens(&self, sensor: &Sensor, moves: bool) -> Self {
        let mut settings = self.clone();
        if moves && settings.groups.is_none() && matches!(sensor.lens, Lens::Thin { .. }) {
            let [least, most] = LENS_GROUPS;
            let wanted = (self.spp / LENS_SAMPLES).clamp(least, most);
            settings.groups = Some(Groups {
                count: equal_groups(self.spp, wanted),
                only: None,
            });
        }
        settings
    }

    /// The groups asked for, or those that standard errors need.
    pub fn groups(&self) -> Groups {
        self.groups.unwrap_or(Groups {
            count: match self.standard_error {
                true => group_count(self.spp),
                false => 1,
            },
            only: None,
        })
    }
}
