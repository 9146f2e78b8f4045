//! What a run did and where its time went.

use super::contender::Contender;
use crate::boundary::mixture::Mixture;
use crate::paths::counts::Counts;
use crate::paths::film::lattice::Pixels;
use crate::paths::integral::{Borders, ByIntegral};
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Instant;

/// What a run did and where its time went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Rays traced, by kind: camera, shadow, bounce, …
    pub rays: BTreeMap<&'static str, u64>,
    /// Borders that were looked for, by the integral.
    pub borders: ByIntegral<Borders>,
    /// Those at which something that moves stands on something else.
    pub standing: u64,
    /// Samples rejected, by cause.
    pub rejected: BTreeMap<&'static str, u64>,
    /// Seconds, by stage.
    pub seconds: BTreeMap<&'static str, f64>,
    /// What the threads spent in tiles, added up over threads: the computation without what
    /// surrounds it.
    pub tile_seconds: f64,
    /// The share that the largest part has in a gradient, by key: of `backward` that of one packet
    /// of paths or one border on the film in the sum of their squares, of a gradient image (under
    /// `gradient`) that of one pixel in a thousand in the variance.
    pub largest_parts: BTreeMap<String, f64>,
    /// What the user must know to trust the result.
    pub warnings: Vec<String>,
    /// Remarks for the user.
    pub notes: Vec<String>,
    /// Of a pilot: the pixels of each tile, and what was done there.
    pub tiles: Vec<(Pixels, Counts)>,
    /// Of `auto`: how it has come to what it does.
    pub pilot: Option<Pilot>,
}

/// How `auto` has come to what it does.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Pilot {
    /// In words.
    pub chosen: String,
    /// Why nothing was tried, if nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub because: Option<String>,
    /// The usual way first.
    pub trials: Vec<Trial>,
    /// Why differences were not taken although they have the least noise for their work.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_differences: Option<String>,
    /// By how much, about, the variance falls for the same work because samples are spent where the
    /// noise lies, if they are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uneven: Option<f64>,
    #[serde(skip)]
    pub seconds: f64,
}

/// What a pilot has tried.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Trial {
    /// In words.
    pub way: String,
    /// Paths that it was looked at with, about.
    pub paths: f64,
    /// Of the job's gradient image, summed over its numbers, as far as those paths tell; of
    /// differences at least what borders that the usual way has found foretell.
    pub variance: f64,
    /// About the job's time, in microseconds of one processor, by its rays.
    pub work: f64,
    /// One over variance and work, by that of the usual way, if both have noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub efficiency: Option<f64>,
}

impl Pilot {
    /// That there was nothing to try.
    pub fn without_trials(because: String) -> Self {
        Self {
            because: Some(because),
            ..Self::default()
        }
    }

    /// In one sentence.
    pub fn summary(&self) -> String {
        let chosen = &self.chosen;
        let tried = self.trials.iter().find(|trial| trial.way == *chosen);
        match (&self.because, tried) {
            (Some(because), _) => format!("auto: {chosen}, because {because}"),
            (None, Some(tried)) if self.trials[0].way != *chosen => {
                let usual = &self.trials[0].way;
                match tried.efficiency {
                    Some(by) if by < 1.0 => format!(
                        "auto: {chosen}, {by:.1} times as efficient in a pilot as {usual}, \
                         of whose noise pilots miss more"
                    ),
                    Some(by) => {
                        format!("auto: {chosen}, {by:.1} times as efficient in a pilot as {usual}")
                    }
                    None => format!("auto: {chosen}, without noise in a pilot, unlike {usual}"),
                }
            }
            _ => format!("auto: {chosen}, as usual"),
        }
    }

    /// All that was tried, a line each, and what came of it.
    pub fn explanation(&self) -> Vec<String> {
        let line = |trial: &Trial| {
            let efficiency = trial.efficiency.map(|by| format!(", efficiency {by:.3}"));
            format!(
                "auto tried {}: {:.0} paths, variance {:.3e}, work {:.3e}{}",
                trial.way,
                trial.paths,
                trial.variance,
                trial.work,
                efficiency.unwrap_or_default()
            )
        };
        let lines = self.trials.iter().map(line);
        let uneven = self.uneven.map(|gain| {
            format!(
                "auto spends samples where the noise lies: 1/{gain:.1} of the variance for the same work"
            )
        });
        let refused = self.no_differences.iter().map(|why| format!("auto: {why}"));
        let lines = lines.chain(refused).chain([self.summary()]);
        lines.chain(uneven).collect()
    }
}

impl Statistics {
    /// Adds to a stage's time.
    pub fn spend(&mut self, stage: &'static str, seconds: f64) {
        *self.seconds.entry(stage).or_default() += seconds;
    }

    /// Keeps what a pilot has come to, and says so if it is not the usual.
    pub fn add_pilot(&mut self, pilot: Pilot) {
        self.spend("pilot", pilot.seconds);
        if pilot.chosen != Contender::Mixture(Mixture::default()).name() {
            self.notes.push(pilot.summary());
        }
        self.pilot = Some(pilot);
    }

    /// Adds the time since `start` to a stage.
    pub fn add_seconds(&mut self, stage: &'static str, start: Instant) {
        self.spend(stage, start.elapsed().as_secs_f64());
    }

    /// Adds what another run did, but for its notes.
    pub fn absorb(&mut self, other: &Statistics) {
        for (&stage, &seconds) in &other.seconds {
            self.spend(stage, seconds);
        }
        for (&kind, &count) in &other.rays {
            *self.rays.entry(kind).or_default() += count;
        }
        self.borders += other.borders;
        self.standing += other.standing;
        for (&cause, &count) in &other.rejected {
            *self.rejected.entry(cause).or_default() += count;
        }
        for warning in &other.warnings {
            if !self.warnings.contains(warning) {
                self.warnings.push(warning.clone());
            }
        }
        self.tile_seconds += other.tile_seconds;
        self.tiles.extend_from_slice(&other.tiles);
        if self.pilot.is_none() {
            self.pilot.clone_from(&other.pilot);
        }
    }

    /// About what part of all that borders bring is missing because some were not found
    /// ([`ByIntegral::missing_part`]); `None` if none is.
    pub fn missing_part(&self) -> Option<f64> {
        let lost = self.borders.all().lost > 0;
        lost.then(|| self.borders.missing_part())?
    }

    /// Adds what tiles counted.
    pub fn add_counts(&mut self, counts: &Counts) {
        let rays = [
            ("camera", counts.camera),
            ("shadow", counts.shadow),
            ("bounce", counts.bounce),
            ("light_cell", counts.light_cell),
            ("bounce_cell", counts.bounce_cell),
            ("sky_cell", counts.environment_cell),
            ("edge", counts.edge),
            ("probe", counts.probe),
            ("relay", counts.relay),
        ];
        for (kind, count) in rays.into_iter().filter(|r| r.1 > 0) {
            *self.rays.entry(kind).or_default() += count;
        }
        self.borders += counts.borders;
        self.standing += counts.standing;
        let rejected = [
            ("not_finite", counts.not_finite),
            ("boundary_not_finite", counts.boundary_not_finite),
            ("gradient_not_finite", counts.gradient_not_finite),
            ("silhouette_not_found", counts.unresolved),
            ("surfaces_coincide", counts.coincident),
            ("normal_turned_round", counts.turned_round),
        ];
        for (cause, count) in rejected.into_iter().filter(|r| r.1 > 0) {
            *self.rejected.entry(cause).or_default() += count;
        }
    }
}
