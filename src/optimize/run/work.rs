//! The loop over steps, and what is written on the way.

use super::advance::advance;
use super::checkpoint;
use super::folder;
use super::record::Record;
use super::state::State;
use crate::jobs::failure::Failure;
use crate::jobs::machine;
use crate::methods::{EngineError, Pilot, Progress, Statistics, Workers};
use crate::optimize::config::Config;
use crate::optimize::problem::{Machine, Problem};
use crate::optimize::results;
use crate::optimize::results::colours::ColourDistance;
use crate::optimize::results::errors::ParameterError;
use crate::optimize::results::geometry::Distance;
use crate::optimize::results::live::Live;
use crate::optimize::step::{Ranks, outcome};
use crate::trace::Backend;
use serde::Serialize;
use std::fs::File;
use std::path::PathBuf;
use std::time::Instant;

/// How a run is run.
#[derive(Clone, Debug)]
pub struct Options {
    pub directory: PathBuf,
    pub resume: bool,
    /// Whether the state of an earlier run may be written over.
    pub fresh: bool,
    pub threads: usize,
    pub backend: Backend,
}

/// Who is told how a run goes.
pub trait Watch: Sync {
    /// Scene and views are there; `done` of `total` steps were made by an earlier run.
    fn begin(&self, done: u64, total: u64);
    /// A step was made.
    fn stepped(&self, record: &Record, total: u64);
    /// Something that the user should know.
    fn warn(&self, text: &str);
    /// Whether the user wants to stop, and by which signal.
    fn signal(&self) -> Option<u8>;
}

/// What a part of a run took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spent {
    pub wall_seconds: f64,
    /// Of all cores together.
    pub processor_seconds: f64,
}

/// Tells what the parts of a run take, one after another.
struct Meter {
    wall: Instant,
    processor: f64,
}

impl Meter {
    fn start() -> Self {
        Self {
            wall: Instant::now(),
            processor: machine::fine_processor_seconds(),
        }
    }

    /// What was spent since the start or the last call.
    fn part(&mut self) -> Spent {
        let before = std::mem::replace(self, Self::start());
        Spent {
            wall_seconds: (self.wall - before.wall).as_secs_f64(),
            processor_seconds: self.processor - before.processor,
        }
    }
}

/// What a run came to.
pub struct Summary {
    pub steps: u64,
    pub ended: Option<String>,
    pub first: Option<Record>,
    pub last: Option<Record>,
    /// Steps in which each view comes once, and the mean loss of the first and the last so many.
    pub round: u64,
    pub round_losses: [Option<f64>; 2],
    /// Steps that were refused.
    pub refused: u64,
    pub errors: Vec<ParameterError>,
    /// Of meshes whose truth is known.
    pub distances: Vec<Distance>,
    /// Of their textures.
    pub colours: Vec<ColourDistance>,
    pub statistics: Statistics,
    /// Of scene, views and structures, which are paid for once; of the loop over steps; of the
    /// results in the end.
    pub spent: [Spent; 3],
    /// Steps made by this process.
    pub own_steps: u64,
    pub warnings: Vec<String>,
    pub files: Vec<String>,
    pub scene_hash: u64,
    /// On meshes and on views that were held out, for people.
    pub known: Vec<String>,
    /// PSNR in decibels of views that were held out, by name.
    pub held_out: Vec<(String, f64)>,
    pub pilot: Option<Pilot>,
    /// The folder is this run's until its report is written.
    pub claim: Option<File>,
}

struct Quiet<'a>(&'a dyn Watch);

impl Progress for Quiet<'_> {
    fn advance(&self, _: u64, _: u64) {}

    fn cancelled(&self) -> bool {
        self.0.signal().is_some()
    }
}

/// Runs an optimisation, or goes on with one.
pub fn run(
    config: Config,
    options: &Options,
    ranks: &dyn Ranks,
    watch: &dyn Watch,
) -> Result<Summary, Failure> {
    let done = whole(config, options, ranks, watch);
    match (done, watch.signal()) {
        (Err(Failure::Interrupted(_)), Some(signal)) => Err(Failure::Interrupted(signal)),
        (done, _) => done,
    }
}

fn whole(
    config: Config,
    options: &Options,
    ranks: &dyn Ranks,
    watch: &dyn Watch,
) -> Result<Summary, Failure> {
    let progress = Quiet(watch);
    let mut meter = Meter::start();
    let loaded = load(config, options, ranks, &progress);
    ranks.agree(outcome(&loaded), &|| {
        loaded.as_ref().map_or(0, |(problem, state, _)| {
            problem.config.hash ^ problem.base.scene.hash ^ state.fingerprint()
        })
    })?;
    let (mut problem, mut state, claim) = loaded?;
    for warning in &problem.warnings {
        watch.warn(warning);
    }
    if ranks.writes() {
        folder::clear(&options.directory, options.fresh)?;
    }
    watch.begin(state.step, problem.config.steps);
    let (setup, first_step) = (meter.part(), state.step);
    let mut statistics = Statistics::default();
    let ended = steps(
        &mut problem,
        &mut state,
        options,
        ranks,
        watch,
        &mut statistics,
    );
    if ranks.writes() {
        checkpoint::write(&options.directory, &problem, &state)?;
        results::curve::write(&options.directory, &problem, &state)?;
    }
    ended?;
    let in_loop = meter.part();
    statistics.spend("load", problem.seconds[0]);
    statistics.spend("targets", problem.seconds[1]);
    let written = match ranks.writes() {
        true => results::finish(&options.directory, &problem, &state, &progress)?,
        false => results::Written::default(),
    };
    for warning in &written.warnings {
        watch.warn(warning);
    }
    let results = meter.part();
    let (round, round_losses) = round(&problem, &state);
    statistics.spend("results", results.wall_seconds);
    Ok(Summary {
        steps: state.step,
        ended: state.ended.clone(),
        first: state.history.first().cloned(),
        last: state.history.last().cloned(),
        round,
        round_losses,
        refused: state.history.iter().filter(|r| r.refused).count() as u64,
        known: written.known(),
        errors: written.errors,
        distances: written.distances,
        colours: written.colours,
        spent: [setup, in_loop, results],
        own_steps: state.step - first_step,
        warnings: problem
            .warnings
            .iter()
            .cloned()
            .chain(statistics.warnings.iter().cloned())
            .chain(written.warnings)
            .collect(),
        statistics,
        files: written.files,
        scene_hash: problem.base.scene.hash,
        pilot: problem.pilot.clone(),
        held_out: written.held_out,
        claim,
    })
}

/// Steps in which each view comes once, and the mean loss of the first and the last so many.
fn round(problem: &Problem, state: &State) -> (u64, [Option<f64>; 2]) {
    let views = problem.views.len() as u64;
    let batch = problem.config.views.batch.unwrap_or(views).min(views);
    let round = views.div_ceil(batch);
    let history = &state.history;
    let most = history.len().min(round as usize);
    let [first, last] = [&history[..most], &history[history.len() - most..]];
    (round, [first, last].map(mean_loss))
}

/// Of some steps, whose views differ from one to the next.
fn mean_loss(records: &[Record]) -> Option<f64> {
    let losses: Vec<f64> = records.iter().filter_map(|r| r.loss).collect();
    (!losses.is_empty()).then(|| losses.iter().sum::<f64>() / losses.len() as f64)
}

/// The scene, the views and the state to begin with, and the claim on the folder of who writes.
fn load(
    config: Config,
    options: &Options,
    ranks: &dyn Ranks,
    progress: &dyn Progress,
) -> Result<(Problem, State, Option<File>), Failure> {
    let check = || folder::check(&options.directory, options.resume, options.fresh);
    check()?;
    let failed = |error: EngineError| Failure::from_engine(error, None);
    let machine = Machine {
        workers: Workers::new(options.threads).map_err(failed)?,
        threads: options.threads,
        backend: options.backend,
    };
    let mut problem = Problem::load(config, machine, progress)?;
    // A script that may be started again says --resume from the first time on.
    let begun = match options.resume && folder::has_state(&options.directory) {
        true => None,
        false => Some(State::start(&problem)?),
    };
    let claim = match ranks.writes() {
        true => Some(folder::claim(&options.directory)?),
        false => None,
    };
    // Again: while the scene was loaded another run may have come and gone.
    check()?;
    let state = match begun {
        Some(state) => state,
        None => checkpoint::read(&options.directory, &problem)?,
    };
    problem.restore_meshes(&state)?;
    Ok((problem, state, claim))
}

/// Makes steps until the last one, or until something ends them.
fn steps(
    problem: &mut Problem,
    state: &mut State,
    options: &Options,
    ranks: &dyn Ranks,
    watch: &dyn Watch,
    statistics: &mut Statistics,
) -> Result<(), Failure> {
    let mut seen = Live::new(&options.directory);
    let ended = shown_steps(problem, state, options, ranks, watch, statistics, &mut seen);
    if ended.is_err() && ranks.writes() {
        // The page must not go on looking for more. What ended the steps is what to tell.
        let _ = seen.write(problem, state, false);
    }
    ended
}

/// The same, with what is shown of them on the way.
fn shown_steps(
    problem: &mut Problem,
    state: &mut State,
    options: &Options,
    ranks: &dyn Ranks,
    watch: &dyn Watch,
    statistics: &mut Statistics,
    seen: &mut Live,
) -> Result<(), Failure> {
    let progress = Quiet(watch);
    let total = problem.config.steps;
    while state.step < total && state.ended.is_none() {
        let wanted = match watch.signal() {
            Some(signal) => Err(Failure::Interrupted(signal)),
            None => Ok(()),
        };
        ranks.agree(wanted, &|| state.fingerprint())?;
        problem.remesh(state)?;
        let found = advance(problem, state, ranks, &progress)?;
        let known = statistics.warnings.len();
        statistics.absorb(&found.statistics);
        for warning in &statistics.warnings[known..] {
            watch.warn(&format!("step {}: {warning}", state.step));
        }
        if let Some(record) = state.history.last() {
            watch.stepped(record, total);
            warn(record, state, watch);
        }
        if !ranks.writes() {
            continue;
        }
        let output = &problem.config.output;
        if state.step.is_multiple_of(output.checkpoint_every) {
            let start = Instant::now();
            checkpoint::write(&options.directory, problem, state)?;
            statistics.add_seconds("write", start);
        }
        let start = Instant::now();
        seen.keep(&found.images);
        let is_due = match output.pictures_every {
            0 => seen.is_due(),
            every => state.step.is_multiple_of(every),
        };
        if is_due {
            seen.write(problem, state, true)?;
        }
        statistics.add_seconds("write", start);
    }
    Ok(())
}

/// The first of each kind of trouble.
fn warn(record: &Record, state: &State, watch: &dyn Watch) {
    let is_first = |has: &dyn Fn(&Record) -> bool| {
        has(record) && state.history.iter().filter(|r| has(r)).count() == 1
    };
    let step = record.step;
    if is_first(&|r| r.refused) {
        watch.warn(&format!(
            "step {step}: the loss or its gradient is not finite; the step is not made, loss.csv says which others are not"
        ));
    }
    if is_first(&|r| r.inverted > 0) {
        watch.warn(&format!(
            "step {step}: {} faces have turned over; smaller steps, or large_steps with a larger lambda, keep meshes whole",
            record.inverted
        ));
    }
}
