//! `warpath optimize`: inverse rendering.

use super::arguments::OptimizeArguments;
use super::exit::Failure;
use super::log::Log;
use super::optimize_progress::OptimizeProgress;
use super::session;
use super::signals::Signals;
use crate::jobs::id::REPORT;
use crate::jobs::machine;
use crate::optimize::config;
use crate::optimize::run::{self, Options, Summary};
use crate::optimize::step::{self, Ranks};
use crate::output::atomic;
use serde_json::json;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Runs the optimisation, writes `report.json`, and says how it went. Of several processes one does
/// so, whichever of them fails.
pub fn run(arguments: &OptimizeArguments, typed: &[OsString]) -> Result<(), Failure> {
    let ranks = step::join()?;
    let done = work(arguments, typed, &*ranks);
    let agreed = ranks.agree(done, &|| 0);
    match ranks.writes() {
        true => agreed,
        false => Ok(()),
    }
}

fn work(
    arguments: &OptimizeArguments,
    typed: &[OsString],
    ranks: &dyn Ranks,
) -> Result<(), Failure> {
    arguments
        .backend
        .require()
        .map_err(|why| Failure::Usage(why.into()))?;
    let log = match ranks.writes() {
        true => Log::new(&arguments.talk),
        false => Log::silent(),
    };
    let config = config::read(&arguments.config, &arguments.overrides)?;
    let options = Options {
        directory: directory(arguments),
        resume: arguments.resume,
        fresh: arguments.fresh,
        threads: session::threads(arguments.threads),
        backend: arguments.backend,
    };
    let progress = OptimizeProgress::new(log, Signals::watch(log));
    let done = run::run(config.clone(), &options, ranks, &progress);
    progress.finish();
    let mut summary = done?;
    if !ranks.writes() {
        return Ok(());
    }
    summary.files.push(REPORT.into());
    let mut report = report(&summary, &config, &options, typed);
    report["processes"] = ranks.count().into();
    let text = serde_json::to_string_pretty(&report)
        .map_err(|error| Failure::System(error.to_string()))?
        + "\n";
    atomic::write(&options.directory.join(REPORT), |file| {
        file.write_all(text.as_bytes())
    })?;
    for line in lines(&summary) {
        log.note(&line);
    }
    let files = summary.files.join(", ");
    log.note(&format!("{}: {files}", options.directory.display()));
    if arguments.talk.json {
        let mut stdout = std::io::stdout().lock();
        stdout.write_all(text.as_bytes())?;
        stdout.flush()?;
    }
    match summary.refused == summary.steps {
        true => Err(Failure::Input(
            "no step was made: the loss or its gradient was never finite".into(),
        )),
        false => Ok(()),
    }
}

fn directory(arguments: &OptimizeArguments) -> PathBuf {
    arguments.output.clone().unwrap_or_else(|| {
        let stem = arguments.config.file_stem().unwrap_or_default();
        Path::new("out").join(format!("optimize-{}", stem.to_string_lossy()))
    })
}

fn lines(summary: &Summary) -> Vec<String> {
    let mut lines = Vec::new();
    let shown = |loss: Option<f64>| loss.map_or("not finite".into(), |v| format!("{v:.4e}"));
    let [first, last] = summary.round_losses;
    let error = summary.last.as_ref().and_then(|last| last.error);
    let by = match (summary.round, error) {
        (1, Some(error)) => format!(" ± {error:.1e}"),
        (1, None) => String::new(),
        (steps, _) => format!(", means of the {steps} steps that see each view once"),
    };
    lines.push(format!(
        "{} steps: the loss went from {} to {}{by}",
        summary.steps,
        shown(first),
        shown(last)
    ));
    if let Some(why) = &summary.ended {
        lines.push(format!("ended before the last step: {why}"));
    }
    for error in &summary.errors {
        lines.push(format!(
            "{}: {:.3e} off the known scene (RMS), {:.3e} at the start",
            error.key, error.end, error.start
        ));
        if let (Some(start), Some(end)) = (error.seen_start, error.seen_end) {
            lines.push(format!(
                "{}: {end:.3e} off where the views see it, {start:.3e} at the start",
                error.key
            ));
        }
    }
    lines.extend(summary.known.iter().cloned());
    if summary.own_steps > 0 {
        let [setup, steps, results] = summary.spent;
        lines.push(format!(
            "{:.2} steps/s; {:.1} s of processor time for set-up, {:.1} s for steps, {:.1} s for results",
            summary.own_steps as f64 / steps.wall_seconds,
            setup.processor_seconds,
            steps.processor_seconds,
            results.processor_seconds
        ));
    }
    lines
}

fn report(
    summary: &Summary,
    config: &config::Config,
    options: &Options,
    typed: &[OsString],
) -> serde_json::Value {
    let arguments: Vec<_> = typed.iter().skip(1).map(|a| a.to_string_lossy()).collect();
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "command": "optimize",
        "arguments": arguments,
        "config": { "path": config.file, "hash": format!("fnv1a64:{:016x}", config.hash) },
        "scene": {
            "path": config.scene,
            "hash": format!("fnv1a64:{:016x}", summary.scene_hash),
            "defines": config.defines.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        },
        "seed": config.seed,
        "method": config.render.method.name(),
        "backend": options.backend.to_string(),
        "threads": options.threads,
        "steps": summary.steps,
        "steps_of_this_process": summary.own_steps,
        "steps_per_second": summary.own_steps as f64 / summary.spent[1].wall_seconds,
        "spent": { "setup": summary.spent[0], "steps": summary.spent[1], "results": summary.spent[2] },
        "ended": summary.ended,
        "refused": summary.refused,
        "first": summary.first,
        "last": summary.last,
        "steps_of_a_round": summary.round,
        "mean_loss_of_round": { "first": summary.round_losses[0], "last": summary.round_losses[1] },
        "parameter_errors": summary.errors,
        "mesh_distances": summary.distances,
        "colour_distances": summary.colours,
        "held_out_psnr_db": summary.held_out.iter().cloned().collect::<std::collections::BTreeMap<_, _>>(),
        "seconds": summary.statistics.seconds,
        "rays": summary.statistics.rays,
        "silhouettes": summary.statistics.borders.all().found,
        "rejected": summary.statistics.rejected,
        "warnings": summary.warnings,
        "pilot": summary.pilot,
        "peak_memory_bytes": machine::peak(),
        "files": summary.files,
    })
}
