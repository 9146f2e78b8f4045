//! `warpath study`: methods beside each other on many scenes.

use super::arguments::StudyArguments;
use super::exit::Failure;
use super::log::Log;
use super::progress::StageProgress;
use super::session;
use super::signals::Signals;
use crate::jobs::id::REPORT;
use crate::jobs::machine;
use crate::output::atomic;
use crate::study::config::Plan;
use crate::study::journal::JOURNAL;
use crate::study::run::{Found, Options, Watch};
use crate::study::{bounds, config, peers, report, run};
use serde_json::json;
use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// Measures, writes everything, and says whether the bounds hold.
pub fn run(arguments: &StudyArguments, typed: &[OsString]) -> Result<(), Failure> {
    let started = Instant::now();
    arguments
        .backend
        .require()
        .map_err(|why| Failure::Usage(why.into()))?;
    let log = Log::new(&arguments.talk);
    let mut plan = config::read(&arguments.config, &arguments.set)?;
    plan.keep(&arguments.only)?;
    let others = plan.peers.as_ref().map(peers::read).transpose()?;
    let bounds = arguments.assert.as_deref().map(bounds::read).transpose()?;
    let bounds = bounds.unwrap_or_default();
    bounds::check(&bounds, &plan)?;
    let options = options(arguments);
    let signals = Signals::watch(log);
    let progress = StageProgress::start("study", log, &signals, 0.0);
    let watch = Watch {
        progress: &progress,
        note: &|text| progress.beside(|| log.note(text)),
    };
    let found = run::run(&plan, &options, &watch);
    progress.finish();
    let found = found.map_err(|failure| match (failure, signals.received()) {
        (Failure::Interrupted(_), Some(signal)) => Failure::Interrupted(signal),
        (failure, _) => failure,
    })?;
    let (directory, rows) = (&options.directory, &found.rows);
    let written = Instant::now();
    let mut files = report::write(directory, &plan, rows, &others.unwrap_or_default())?;
    if let Some(path) = &arguments.report {
        put(path, &report::table::markdown(&plan, rows))?;
    }
    // Charts, and what else one would look at; the rest was written on the way.
    let charts = files.len();
    files.extend([REPORT, JOURNAL, "gradients/"].map(String::from));
    let beside = [Some(&options.references), arguments.report.as_ref()];
    files.extend(
        beside
            .into_iter()
            .flatten()
            .filter(|path| path.exists())
            .map(|path| name_of(path, directory)),
    );
    let report = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "command": "study",
        "arguments": typed.iter().skip(1).map(|a| a.to_string_lossy()).collect::<Vec<_>>(),
        "scenes": scenes(&plan, &found),
        "seed": plan.seed,
        "backend": options.backend.to_string(),
        "threads": options.threads,
        "seconds": {
            "load": found.load_seconds,
            "measure": found.measure_seconds,
            "write": written.elapsed().as_secs_f64(),
            "total": started.elapsed().as_secs_f64(),
        },
        "peak_memory_bytes": machine::peak(),
        "files": files,
    });
    put(&directory.join(REPORT), &format!("{report:#}\n"))?;
    let seconds = started.elapsed().as_secs_f64();
    log.note(&format!(
        "{}: study.html and {} more ({seconds:.0} s)",
        directory.display(),
        charts
    ));
    if arguments.talk.json {
        let mut stdout = std::io::stdout().lock();
        stdout.write_all(report::values::json(&plan, rows)?.as_bytes())?;
        stdout.flush()?;
    }
    let broken = bounds::broken(&bounds, rows);
    match broken.is_empty() {
        true => Ok(()),
        false => Err(Failure::Disagreement(broken.join("\n"))),
    }
}

/// As the reports of other commands say it, and what was measured of each.
fn scenes(plan: &Plan, found: &Found) -> Vec<serde_json::Value> {
    let scenes = plan.scenes.iter().zip(&found.scene_hashes);
    scenes
        .map(|(scene, hash)| {
            let methods = scene.effort.methods.iter().map(|one| &one.name);
            json!({
                "name": scene.name,
                "path": scene.file.display().to_string(),
                "hash": format!("fnv1a64:{hash:016x}"),
                "defines": scene.defines.iter().cloned().collect::<BTreeMap<_, _>>(),
                "methods": methods.collect::<Vec<_>>(),
                "spp": scene.effort.spp,
            })
        })
        .collect()
}

/// Of what is in the directory, from there.
fn name_of(path: &Path, directory: &Path) -> String {
    let name = path.strip_prefix(directory).unwrap_or(path);
    let end = if path.is_dir() { "/" } else { "" };
    format!("{}{end}", name.display())
}

fn options(arguments: &StudyArguments) -> Options {
    let stem = arguments
        .config
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let usual = || Path::new("out").join(format!("study-{stem}"));
    let directory = arguments.output.clone().unwrap_or_else(usual);
    let references = arguments.references.clone();
    Options {
        references: references.unwrap_or_else(|| directory.join("references")),
        directory,
        table: arguments.report.clone(),
        resume: arguments.resume,
        threads: session::threads(arguments.threads),
        backend: arguments.backend,
    }
}

fn put(path: &Path, text: &str) -> Result<(), Failure> {
    Ok(atomic::write(path, |file| file.write_all(text.as_bytes()))?)
}
