//! The folder that a run writes into: one run at a time, and nothing in it of an earlier one.

use super::checkpoint;
use crate::jobs::failure::Failure;
use crate::jobs::id::REPORT;
use crate::optimize::results::{curve, page};
use crate::output::atomic;
use serde_json::Value;
use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Component, Path};

/// A folder with the state of another run is not written over.
pub fn check(directory: &Path, resume: bool, fresh: bool) -> Result<(), Failure> {
    match has_state(directory) && !resume && !fresh {
        true => Err(Failure::Usage(format!(
            "{} has the checkpoint of an earlier run; --resume goes on with it, -o takes another folder, --fresh begins anew",
            directory.display()
        ))),
        false => Ok(()),
    }
}

/// Whether there is a run to go on with.
pub fn has_state(directory: &Path) -> bool {
    directory.join(checkpoint::NAME).exists()
}

/// Makes the folder this run's alone for as long as what is returned is kept: two in one folder
/// would write over each other's files.
pub fn claim(directory: &Path) -> Result<File, Failure> {
    atomic::prepare_directory(directory)?;
    Ok(atomic::claim(directory, "run")?)
}

/// Takes away what does not belong to the run that now begins or goes on: what processes that were
/// killed had begun to write, the report, and all that an earlier run wrote if this is a `fresh`
/// one.
pub fn clear(directory: &Path, fresh: bool) -> Result<(), Failure> {
    atomic::sweep(directory);
    atomic::sweep(&directory.join("scene"));
    let earlier = match fresh && has_state(directory) {
        true => written(directory),
        false => Vec::new(),
    };
    atomic::take_away(&directory.join(REPORT))?;
    for name in earlier {
        atomic::take_away(&directory.join(name))?;
    }
    if fresh {
        // Stays where there is anything else in it.
        let _ = fs::remove_dir(directory.join("scene"));
    }
    Ok(())
}

/// What an earlier run has written: what its report names if it came to one, and what is written
/// while a run goes on.
fn written(directory: &Path) -> Vec<OsString> {
    let text = fs::read(directory.join(REPORT)).unwrap_or_default();
    let report: Value = serde_json::from_slice(&text).unwrap_or_default();
    let told = match report["command"] == "optimize" {
        true => report["files"].as_array().cloned().unwrap_or_default(),
        false => Vec::new(),
    };
    let told = told.iter().filter_map(Value::as_str);
    let told = told.filter(|name| is_below(name)).map(OsString::from);
    let always = [checkpoint::NAME, curve::CSV, curve::SVG, page::NAME].map(OsString::from);
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name());
    let views = names.filter(|name| page::is_view(&name.to_string_lossy()));
    told.chain(always).chain(views).collect()
}

/// Whether a name leads to nothing outside of the folder that it is in.
fn is_below(name: &str) -> bool {
    let mut parts = Path::new(name).components();
    parts.all(|part| matches!(part, Component::Normal(_)))
}
