//! A whole study, direction by direction.

use super::cell::{ReferenceFigures, Row};
use super::config::{Plan, ScenePlan};
use super::journal::Journal;
use super::measure;
use super::reference::{self, Reference};
use super::report::gradients;
use super::task::{Task, program_hash};
use crate::jobs::failure::Failure;
use crate::methods::Progress;
use crate::output::atomic;
use crate::scene::{self, Filter, Scene};
use crate::trace::Backend;
use std::path::PathBuf;
use std::time::Instant;

/// Where and with what.
#[derive(Clone, Debug)]
pub struct Options {
    pub directory: PathBuf,
    /// References that were made, which other studies may share.
    pub references: PathBuf,
    /// Where a table goes beside the results, if anywhere: it is seen to that it can.
    pub table: Option<PathBuf>,
    pub resume: bool,
    pub threads: usize,
    pub backend: Backend,
}

/// Who is told how far it is.
pub struct Watch<'a> {
    pub progress: &'a dyn Progress,
    pub note: &'a dyn Fn(&str),
}

/// What a run is told to do with `Progress`: it may stop it, and counts nothing.
struct Silent<'a>(&'a dyn Progress);

impl Progress for Silent<'_> {
    fn advance(&self, _: u64, _: u64) {}
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// What a study has found.
pub struct Found {
    /// In the order of the configuration.
    pub rows: Vec<Row>,
    /// FNV-1a of everything that was read of each scene of the plan.
    pub scene_hashes: Vec<u64>,
    pub load_seconds: f64,
    pub measure_seconds: f64,
}

/// Measures what is not yet in the journal.
pub fn run(plan: &Plan, options: &Options, watch: &Watch) -> Result<Found, Failure> {
    let started = Instant::now();
    // All scenes before the first run: hours must not end in a typing error.
    let scenes: Vec<Scene> = plan.scenes.iter().map(load).collect::<Result<_, _>>()?;
    let loaded = Instant::now();
    let program = program_hash()?;
    let mut tasks = Vec::new();
    for (scene, of) in scenes.iter().zip(&plan.scenes) {
        for moves in &of.directions {
            let (threads, backend) = (options.threads, options.backend);
            let task = Task::new(scene, plan, of, moves, threads, backend, program)?;
            tasks.push(task);
        }
    }
    if let Some(table) = &options.table {
        atomic::prepare_file(table)?;
    }
    let mut journal = Journal::open(&options.directory, options.resume)?;
    // The journal is locked: what is unfinished here is nobody's.
    atomic::sweep(&options.directory);
    atomic::sweep(&options.directory.join(gradients::FOLDER));
    let cost = |task: &Task| match journal.find(task.key) {
        Some(_) => 0,
        None => reference::paths(task) + measure::paths(task),
    };
    let costs: Vec<u64> = tasks.iter().map(cost).collect();
    let total: u64 = costs.iter().sum();
    let mut rows = Vec::new();
    let mut before = 0;
    for (number, (task, cost)) in tasks.iter().zip(costs).enumerate() {
        let row = match journal.find(task.key) {
            Some(row) => row.clone(),
            None => {
                let started = Instant::now();
                let mut done = before;
                let mut count = |paths: u64| {
                    done += paths;
                    watch.progress.advance(done, total);
                };
                let row = one(task, options, &Silent(watch.progress), &mut count)?;
                journal.add(task.key, row.clone())?;
                (watch.note)(&format!(
                    "{} of {}: {} {}: {} ({:.1} s)",
                    number + 1,
                    tasks.len(),
                    row.scene,
                    row.direction,
                    verdicts(&row),
                    started.elapsed().as_secs_f64()
                ));
                row
            }
        };
        before += cost;
        watch.progress.advance(before, total);
        rows.push(row);
    }
    Ok(Found {
        rows,
        scene_hashes: scenes.iter().map(|scene| scene.hash).collect(),
        load_seconds: (loaded - started).as_secs_f64(),
        measure_seconds: loaded.elapsed().as_secs_f64(),
    })
}

fn load(plan: &ScenePlan) -> Result<Scene, Failure> {
    let scene = scene::load(&plan.file, &plan.defines).map_err(Failure::from);
    scene.map_err(|failure| match failure {
        Failure::Input(what) => Failure::Input(format!("{}: {}: {what}", plan.place, plan.name)),
        other => other,
    })
}

fn one(
    task: &Task,
    options: &Options,
    progress: &dyn Progress,
    done: &mut dyn FnMut(u64),
) -> Result<Row, Failure> {
    let folder = &options.references;
    let reference = reference::obtain(task, folder, progress, done)?;
    let measured = measure::measure(task, &reference, progress, done)?;
    gradients::write(&options.directory, task, &reference, &measured)?;
    let film = &task.scene.sensors[task.settings.sensor].film;
    Ok(Row {
        scene: task.plan.name.clone(),
        direction: task.name.into(),
        symptom: task.plan.symptom.clone(),
        peer: task.plan.peer.clone(),
        filter: filter_name(&film.filter).into(),
        size: task.size,
        reference: figures_of(task, &reference),
        cells: measured.cells,
    })
}

fn figures_of(task: &Task, reference: &Reference) -> ReferenceFigures {
    ReferenceFigures {
        rms: reference.rms,
        noise: reference.noise() / reference.unit(),
        runs: task.plan.effort.reference.runs,
        spp: task.plan.effort.reference.spp,
        ladder: reference.ladder.clone(),
    }
}

fn filter_name(filter: &Filter) -> &'static str {
    match filter {
        Filter::Box { .. } => "box",
        Filter::Tent { .. } => "tent",
        Filter::Gaussian { .. } => "gaussian",
    }
}

/// What is said of each method at the most samples.
fn verdicts(row: &Row) -> String {
    let most = row.cells.iter().map(|cell| cell.spp).max();
    let last = row.cells.iter().filter(|cell| Some(cell.spp) == most);
    let words = last.map(|cell| format!("{} {}", cell.method, cell.verdict.kind.name()));
    words.collect::<Vec<_>>().join(", ")
}
