//! `warpath batch`: many jobs, from a file or from standard input.

use super::arguments::{BatchArguments, SplitName};
use super::batch_progress::BatchProgress;
use super::exit::Failure;
use super::log::Log;
use super::session;
use super::signals::Signals;
use super::values::Memory;
use crate::batch::options::Options;
use crate::batch::queue::shard::Split;
use crate::batch::results::summary::Summary;
use crate::batch::run;
use crate::jobs::id::REPORT;
use crate::jobs::{machine, schema};
use crate::output::atomic;
use serde_json::json;
use std::ffi::OsString;
use std::io::{BufReader, Write};
use std::path::{Path, PathBuf};

/// Runs the jobs, writes `report.json`, and says how it went.
pub fn run(arguments: &BatchArguments, typed: &[OsString]) -> Result<(), Failure> {
    let Some(jobs) = &arguments.jobs else {
        return print(&schema::text());
    };
    let is_stream = jobs.as_os_str() == "-";
    if is_stream && arguments.shard.is_some() {
        return Err(Failure::Usage(
            "--shard shares out a job file; a stream is for one worker".into(),
        ));
    }
    arguments
        .backend
        .require()
        .map_err(|why| Failure::Usage(why.into()))?;
    let log = Log::new(&arguments.talk);
    let options = options(arguments, jobs)?;
    let progress = BatchProgress::new(log, Signals::watch(log));
    let summary = match is_stream {
        true => {
            let input = BufReader::new(std::io::stdin());
            run::of_stream(input, Box::new(std::io::stdout()), &options, &progress)
        }
        false => run::of_file(jobs, &options, &progress),
    };
    progress.finish();
    let summary = summary?;
    let text = report(&summary, &options, typed)?;
    atomic::write(&options.directory.join(REPORT), |file| {
        file.write_all(text.as_bytes())
    })?;
    for line in summary.lines() {
        log.note(&line);
    }
    log.note(&format!(
        "{}: results.jsonl, report.json",
        options.directory.display()
    ));
    // On a stream, standard output is for answers alone.
    if arguments.talk.json && !is_stream {
        print(&text)?;
    }
    match summary.failed {
        0 => Ok(()),
        failed => Err(Failure::Jobs(failed, summary.jobs)),
    }
}

fn options(arguments: &BatchArguments, jobs: &Path) -> Result<Options, Failure> {
    let variables = std::env::vars_os()
        .filter_map(|(name, value)| Some((name.into_string().ok()?, value.into_string().ok()?)))
        .collect();
    let shard = arguments
        .shard
        .map(|shard| shard.resolve(&variables))
        .transpose()?;
    let directory = arguments.output.clone().unwrap_or_else(|| {
        let stem = jobs.file_stem().unwrap_or_default().to_string_lossy();
        let stem = if stem == "-" { "stream".into() } else { stem };
        Path::new("out").join(format!("batch-{stem}"))
    });
    let directory = match (shard, directory.to_str()) {
        (Some(shard), Some(text)) => {
            let name = format!("{}-of-{}", shard.index, shard.count);
            PathBuf::from(text.replace("{shard}", &name))
        }
        _ => directory,
    };
    Ok(Options {
        directory,
        resume: arguments.resume,
        threads: session::threads(arguments.threads),
        memory_bytes: match arguments.memory {
            Memory::Bytes(bytes) => bytes,
            Memory::Share(share) => (machine::of_machine() as f64 * share) as u64,
        },
        shard,
        split: match arguments.split {
            SplitName::Jobs => Split::Jobs,
            SplitName::Samples => Split::Samples,
        },
        backend: arguments.backend,
    })
}

fn report(summary: &Summary, options: &Options, typed: &[OsString]) -> Result<String, Failure> {
    let arguments: Vec<_> = typed.iter().skip(1).map(|a| a.to_string_lossy()).collect();
    let report = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "command": "batch",
        "arguments": arguments,
        "backend": options.backend.to_string(),
        "summary": summary,
        "jobs_per_second": summary.jobs_rate(),
        "core_utilisation": summary.utilisation(),
    });
    serde_json::to_string_pretty(&report)
        .map(|text| text + "\n")
        .map_err(|error| Failure::System(error.to_string()))
}

fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}
