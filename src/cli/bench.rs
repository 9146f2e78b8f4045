//! `warpath bench`: Embree against obvhs.

use super::arguments::BenchArguments;
use super::exit::Failure;
use super::log::Log;
use super::progress::StageProgress;
use super::signals::Signals;
use crate::bench::cases::Case;
use crate::bench::meshes::Class;
use crate::bench::{self, Budget, Plan, Results, chart, table};
use crate::jobs::machine;
use crate::methods::Progress;
use crate::output::atomic;
use crate::scene::SceneError;
use serde_json::json;
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What is measured, before it is loaded: meshes of millions of triangles are made one at a time.
enum Source<'a> {
    Generated(Class, usize),
    File(&'a Path),
}

/// Measures, writing down after each case what is known by then.
pub fn run(arguments: &BenchArguments, typed: &[OsString]) -> Result<(), Failure> {
    let started = Instant::now();
    let log = Log::new(&arguments.talk);
    let signals = Signals::watch(log);
    let threads = arguments
        .threads
        .unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |cores| cores.get()));
    let plan = Plan {
        budget: Budget {
            seconds: arguments.seconds,
        },
        threads,
    };
    let sources = sources(arguments);
    let directory = arguments
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from("out/bench"));
    // Each by itself, as they are measured: together they might not fit.
    for source in sources.iter().skip(1) {
        source.check()?;
    }
    let mut results = Results::new(plan);
    for (i, source) in sources.iter().enumerate() {
        let case = source.load()?;
        // Only now: a mesh that is not there leaves nothing behind.
        atomic::prepare_directory(&directory)?;
        let title = format!("{} of {}: {}", i + 1, sources.len(), case.name);
        log.note(&title);
        let progress = StageProgress::start("bench", log, &signals, 0.0);
        let steps = bench::steps(&case, plan);
        let mut done = 0;
        let outcome = bench::measure(&case, plan, &progress, &mut |record| {
            results.records.push(record);
            done += 1;
            progress.advance(done, steps);
        });
        progress.finish();
        write(&directory, &results)?;
        outcome.map_err(|error| Failure::from_engine(error, signals.received()))?;
    }
    let report = json!({
        "version": results.version,
        "command": "bench",
        "arguments": typed.iter().skip(1).map(|a| a.to_string_lossy()).collect::<Vec<_>>(),
        "threads": threads,
        "seconds": {"total": started.elapsed().as_secs_f64()},
        "peak_memory_bytes": machine::peak(),
        "files": ["bench.json", "bench.svg", "report.json"],
    });
    put(&directory, "report.json", &format!("{report:#}\n"))?;
    let seconds = started.elapsed().as_secs_f64();
    log.note(&format!(
        "{}: bench.json, bench.svg, report.json ({seconds:.0} s)",
        directory.display()
    ));
    let text = if arguments.talk.json {
        json_text(&results)?
    } else {
        table::markdown(&results)
    };
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(text.as_bytes())?;
    Ok(stdout.flush()?)
}

fn sources(arguments: &BenchArguments) -> Vec<Source<'_>> {
    if !arguments.files.is_empty() {
        return arguments.files.iter().map(|f| Source::File(f)).collect();
    }
    let sizes = arguments.triangles.iter();
    sizes
        .flat_map(|&count| Class::ALL.map(|class| Source::Generated(class.0, count as usize)))
        .collect()
}

impl Source<'_> {
    /// Refuses a file that cannot be loaded.
    fn check(&self) -> Result<(), SceneError> {
        match self {
            Source::Generated(..) => Ok(()),
            Source::File(_) => self.load().map(drop),
        }
    }

    fn load(&self) -> Result<Case, SceneError> {
        match self {
            Source::Generated(class, count) => Case::generated(*class, *count),
            Source::File(path) => Case::file(path),
        }
    }
}

fn write(directory: &Path, results: &Results) -> Result<(), Failure> {
    put(directory, "bench.json", &json_text(results)?)?;
    put(directory, "bench.svg", &chart::svg(results))
}

fn json_text(results: &Results) -> Result<String, Failure> {
    let text = serde_json::to_string_pretty(results);
    Ok(text.map_err(|error| Failure::System(error.to_string()))? + "\n")
}

fn put(directory: &Path, name: &str, text: &str) -> Result<(), Failure> {
    Ok(atomic::write(&directory.join(name), |file| {
        file.write_all(text.as_bytes())
    })?)
}
