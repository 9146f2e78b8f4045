//! `warpath merge`: shards of a batch into one.

use super::arguments::MergeArguments;
use super::exit::Failure;
use super::log::Log;
use super::signals::Signals;
use crate::batch::merge;
use crate::jobs::id::{REPORT, RESULTS};
use crate::jobs::machine;
use crate::output::atomic;
use serde_json::json;
use std::ffi::OsString;
use std::io::Write;
use std::time::Instant;

/// Merges, writes `report.json`, and says what.
pub fn run(arguments: &MergeArguments, typed: &[OsString]) -> Result<(), Failure> {
    let started = Instant::now();
    let log = Log::new(&arguments.talk);
    Signals::watch(log);
    let merged = merge::merge(&arguments.shards, &arguments.output)?;
    let mut files: Vec<&str> = merged.files.iter().map(String::as_str).collect();
    files.extend([RESULTS, REPORT]);
    let report = json!({
        "version": env!("CARGO_PKG_VERSION"),
        "command": "merge",
        "arguments": typed.iter().skip(1).map(|a| a.to_string_lossy()).collect::<Vec<_>>(),
        "backend": merged.backend,
        "jobs": merged.jobs,
        "shards": merged.shards,
        "seconds": {"total": started.elapsed().as_secs_f64()},
        "rays": merged.rays,
        "rejected": merged.rejected,
        "peak_memory_bytes": machine::peak(),
        "files": files,
    });
    let text = format!("{report:#}\n");
    atomic::write(&arguments.output.join(REPORT), |file| {
        file.write_all(text.as_bytes())
    })?;
    log.note(&format!(
        "{}: {} jobs of {} shards, report.json",
        arguments.output.display(),
        merged.jobs,
        merged.shards
    ));
    if arguments.talk.json {
        let mut stdout = std::io::stdout().lock();
        stdout.write_all(text.as_bytes())?;
        stdout.flush()?;
    }
    Ok(())
}
