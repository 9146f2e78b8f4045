//! `warpath merge`: shards of a batch into one.

use super::arguments::MergeArguments;
use super::exit::Failure;
use super::log::Log;
use super::signals::Signals;
use crate::batch::merge;
use serde_json::json;
use std::io::Write;

/// Merges, and says what.
pub fn run(arguments: &MergeArguments) -> Result<(), Failure> {
    let log = Log::new(&arguments.talk);
    Signals::watch(log);
    let merged = merge::merge(&arguments.shards, &arguments.output)?;
    log.note(&format!(
        "{}: {} jobs of {} shards",
        arguments.output.display(),
        merged.jobs,
        merged.shards
    ));
    if arguments.talk.json {
        let mut stdout = std::io::stdout().lock();
        writeln!(
            stdout,
            "{}",
            json!({"jobs": merged.jobs, "shards": merged.shards})
        )?;
        stdout.flush()?;
    }
    Ok(())
}
