//! `report.json`: what was run, on what, and what it cost.

use crate::methods::{MOST_OF_ONE_PART, Pilot, Settings, Statistics};
use serde::Serialize;
use std::collections::BTreeMap;

/// A smaller share of silhouettes than this may be missing without a warning.
const MISSING_SHARE: f64 = 1e-3;

/// The report of one run.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    pub version: &'static str,
    pub command: &'static str,
    pub arguments: Vec<String>,
    pub scene: SceneReport,
    pub sensor: usize,
    pub resolution: [u32; 2],
    pub spp: u32,
    pub seed: u64,
    /// Null for no limit.
    pub max_depth: Option<u32>,
    pub method: Option<&'static str>,
    pub backend: String,
    pub threads: usize,
    /// By stage. `primal` traces paths and finds silhouettes, `adjoint` differentiates them,
    /// forward as well; the threads do both in turn, and the time is parted by what each took.
    /// `total` is the whole run.
    pub seconds: BTreeMap<String, f64>,
    pub rays: BTreeMap<String, u64>,
    /// Samples of borders that were found: pieces of outlines, chains, ends of shadows.
    pub silhouettes: u64,
    pub rejected: BTreeMap<String, u64>,
    /// See [`Statistics::missing_part`].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing_part: Option<f64>,
    /// See [`Statistics::largest_parts`].
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub largest_parts: BTreeMap<String, f64>,
    pub warnings: Vec<String>,
    /// Warnings of the engine that are still to be given.
    #[serde(skip)]
    doubts: Vec<String>,
    pub notes: Vec<String>,
    /// How `auto` has come to what it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pilot: Option<Pilot>,
    pub peak_memory_bytes: Option<u64>,
    /// What the command found: the loss, norms, a verdict.
    pub results: serde_json::Map<String, serde_json::Value>,
    /// Names in the output directory.
    pub files: Vec<String>,
}

/// Which scene it was.
#[derive(Clone, Debug, Serialize)]
pub struct SceneReport {
    pub path: String,
    /// FNV-1a of everything that was read.
    pub hash: String,
    pub defines: BTreeMap<String, String>,
}

impl Report {
    /// Fills in what is known before anything is traced.
    pub fn new(
        command: &'static str,
        scene: SceneReport,
        settings: &Settings,
        resolution: [u32; 2],
    ) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION"),
            command,
            arguments: Vec::new(),
            scene,
            sensor: settings.sensor,
            resolution,
            spp: settings.spp,
            seed: settings.seed,
            max_depth: Some(settings.max_depth).filter(|depth| *depth != u32::MAX),
            method: None,
            backend: settings.backend.to_string(),
            threads: settings.threads,
            seconds: BTreeMap::new(),
            rays: BTreeMap::new(),
            silhouettes: 0,
            rejected: BTreeMap::new(),
            missing_part: None,
            largest_parts: BTreeMap::new(),
            warnings: Vec::new(),
            doubts: Vec::new(),
            notes: Vec::new(),
            pilot: None,
            peak_memory_bytes: None,
            results: serde_json::Map::new(),
            files: Vec::new(),
        }
    }

    /// Adds what a run of the engine did to what earlier runs did.
    pub fn absorb(&mut self, statistics: &Statistics) {
        add(&mut self.seconds, &statistics.seconds);
        add(&mut self.rays, &statistics.rays);
        self.silhouettes += statistics.borders.all().found;
        add(&mut self.rejected, &statistics.rejected);
        let parts = [self.missing_part, statistics.missing_part()];
        self.missing_part = parts.into_iter().flatten().reduce(f64::max);
        for (key, &share) in &statistics.largest_parts {
            let most = self.largest_parts.entry(key.clone()).or_default();
            *most = most.max(share);
        }
        if statistics.pilot.is_some() {
            self.pilot.clone_from(&statistics.pilot);
        }
        for warning in &statistics.warnings {
            if !self.doubts.contains(warning) {
                self.doubts.push(warning.clone());
            }
        }
        for note in &statistics.notes {
            if !self.notes.contains(note) {
                self.notes.push(note.clone());
            }
        }
    }

    /// What was lost on the way, where it matters.
    pub fn losses(&self) -> Vec<String> {
        let mut losses = self.doubts.clone();
        for (cause, &count) in self.rejected.iter().filter(|(_, count)| **count > 0) {
            let cells = count + self.silhouettes;
            match cause.as_str() {
                "silhouette_not_found" if count as f64 <= MISSING_SHARE * cells as f64 => {}
                "silhouette_not_found" => losses.push(format!(
                    "{count} of {cells} cells had no silhouette found; their part of the gradient is missing{}",
                    self.missing_part.map_or(String::new(), |part| format!(
                        ", about {:.2} % of what silhouettes bring if they are like the others",
                        100.0 * part
                    ))
                )),
                "surfaces_coincide" => losses.push(format!(
                    "at {count} places surfaces lie in one plane, and it is chance which of them is seen: how that \
                     changes is missing from the gradient; move them apart"
                )),
                "normal_turned_round" => losses.push(format!(
                    "at {count} places normals of a normalmap or bumpmap look away from the ray and are turned round; \
                     how the border of such places moves is missing from the gradient"
                )),
                cause => losses.push(format!(
                    "{count} {} were not finite and count as zero: the scene has numbers that are too large \
                     or too small",
                    match cause {
                        "not_finite" => "samples",
                        "boundary_not_finite" => "jumps at edges",
                        _ => "terms of the gradient",
                    }
                )),
            }
        }
        let uncertain = self
            .largest_parts
            .iter()
            .filter(|(_, s)| **s > MOST_OF_ONE_PART);
        losses.extend(uncertain.map(|(key, share)| {
            let (part, whole) = match key.as_str() {
                "gradient" => ("one pixel in a thousand", "the variance"),
                _ => ("one packet of paths", "the sum of their squares"),
            };
            // A pilot has looked for the best already.
            let advice = match key.as_str() {
                "gradient" if self.pilot.is_none() => "take more samples, or --method auto",
                _ => "take more samples",
            };
            format!(
                "few samples carry {key}: {part} has {} % of {whole}, and its standard error may be too small; {advice}",
                (100.0 * share).round(),
            )
        }));
        losses
    }

    /// Adds to one stage's seconds.
    pub fn spend(&mut self, stage: &str, seconds: f64) {
        *self.seconds.entry(stage.into()).or_default() += seconds;
    }
}

fn add<T: Copy + Default + std::ops::AddAssign>(
    sums: &mut BTreeMap<String, T>,
    terms: &BTreeMap<&'static str, T>,
) {
    for (&name, &term) in terms {
        *sums.entry(name.into()).or_default() += term;
    }
}
