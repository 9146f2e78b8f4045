//! A job: one line of JSON.

use super::define::Define;
use super::mode::{Loss, Mode};
use super::numbers::Numbers;
use super::pairs::{Keys, Pairs};
use super::resolution::Resolution;
use super::settings::RequestedSettings;
use crate::methods::Method;
use crate::output::results;
use crate::trace::Backend;
use schemars::JsonSchema;
use serde::Deserialize;
use std::path::PathBuf;

/// One image or gradient to compute. What is left out comes from the scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "A line of a warpath batch")]
pub struct Job {
    /// Names the job and its folder, once in a batch: letters, digits, '-', '_' and '.', not first
    /// a '.'
    #[schemars(
        length(min = 1, max = 128),
        regex(pattern = r"^[A-Za-z0-9_-][A-Za-z0-9._-]*$")
    )]
    pub id: String,
    pub mode: Mode,
    /// Scene file (Mitsuba 3 XML), from the working directory
    pub scene: PathBuf,
    /// Values for the $names of the scene
    #[serde(default)]
    pub defines: Pairs<Define>,
    /// Parameter values in place of the scene's, applied in the order in which they are written
    #[serde(default)]
    pub set: Pairs<Numbers>,
    /// forward: tangents by key, which together make one direction; backward: a list of keys
    #[serde(default)]
    pub params: Option<Keys>,
    /// backward: the derivative of the loss by the image (any picture file, .npy)
    #[serde(default)]
    pub adjoint: Option<PathBuf>,
    /// backward: the picture to compare the image with
    #[serde(default)]
    pub target: Option<PathBuf>,
    /// backward, with a target: how the image is compared [default: l2]
    #[serde(default)]
    pub loss: Option<Loss>,
    /// Which of the scene's sensors renders, counted from 0
    #[serde(default)]
    pub sensor: usize,
    /// Camera paths per pixel
    #[serde(default)]
    #[schemars(range(min = 1, max = 1048576))]
    pub spp: Option<u32>,
    /// Seed of the random numbers
    #[serde(default)]
    pub seed: Option<u64>,
    /// forward, backward: how visibility is differentiated [default: auto]
    #[serde(default)]
    pub method: Option<Method>,
    /// Longest path in segments, -1 for no limit
    #[serde(default)]
    #[schemars(range(min = -1))]
    pub max_depth: Option<i64>,
    /// Width and height of the image in pixels: [640, 480] or "640x480"
    #[serde(default)]
    pub resolution: Option<Resolution>,
    /// forward, backward: whether to write standard errors [default: true]
    #[serde(default)]
    pub stderr: Option<bool>,
    /// Independent groups of samples; divides spp [default: the least divisor of spp from 4]
    #[serde(default)]
    #[schemars(range(min = 1))]
    pub groups: Option<u32>,
    /// Names of the files to write [default: all that the command of this name writes]; render has
    /// image.npy too, on request
    #[serde(default)]
    pub outputs: Option<Vec<String>>,
}

impl Job {
    /// What it asks of the engine; `threads` is for the engine's own reports.
    pub fn settings(&self, threads: usize, backend: Backend) -> RequestedSettings {
        RequestedSettings {
            sensor: self.sensor,
            spp: self.spp,
            seed: self.seed,
            max_depth: self
                .max_depth
                .map(|depth| u32::try_from(depth).unwrap_or(u32::MAX)),
            resolution: self.resolution.map(|resolution| resolution.0),
            method: self.method.unwrap_or_default(),
            backend,
            standard_error: self.mode != Mode::Render && self.stderr.unwrap_or(true),
            groups: self.groups,
            threads,
        }
    }

    /// The `-D name=value` of its scene.
    pub fn definitions(&self) -> Vec<(String, String)> {
        let pairs = self.defines.0.iter();
        pairs
            .map(|(name, value)| (name.clone(), value.text()))
            .collect()
    }

    /// Whether a file of this name is to be written.
    pub fn writes(&self, name: &str) -> bool {
        results::is_wanted(name, self.outputs.as_deref())
    }
}
