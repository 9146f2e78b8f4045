//! What of a job contradicts itself.

use super::failure::Failure;
use super::id::check_id;
use super::job::Job;
use super::mode::Mode;
use super::pairs::Keys;
use super::settings::MOST_SAMPLES;
use crate::output::results::STDERR;

/// Refuses a job that no scene could serve.
pub fn check(job: &Job) -> Result<(), Failure> {
    check_id(&job.id)?;
    check_numbers(job)?;
    check_fields(job)?;
    check_parameters(job)?;
    if job.mode == Mode::Backward {
        check_objective(job)?;
    }
    check_outputs(job)
}

fn refuse(what: impl Into<String>) -> Result<(), Failure> {
    Err(Failure::Input(what.into()))
}

fn check_numbers(job: &Job) -> Result<(), Failure> {
    if job.spp.is_some_and(|n| !(1..=MOST_SAMPLES).contains(&n)) {
        return refuse(format!(
            "spp: write a whole number from 1 to {MOST_SAMPLES}"
        ));
    }
    if job.max_depth.is_some_and(|depth| depth == 0 || depth < -1) {
        return refuse("max_depth: write a number of segments from 1, or -1 for no limit");
    }
    Ok(())
}

/// Each mode has fields of its own.
fn check_fields(job: &Job) -> Result<(), Failure> {
    let gradients: &[Mode] = &[Mode::Forward, Mode::Backward];
    let fields = [
        ("params", job.params.is_some(), gradients),
        ("method", job.method.is_some(), gradients),
        ("stderr", job.stderr.is_some(), gradients),
        ("adjoint", job.adjoint.is_some(), &[Mode::Backward]),
        ("target", job.target.is_some(), &[Mode::Backward]),
        ("loss", job.loss.is_some(), &[Mode::Backward]),
    ];
    for (field, is_given, modes) in fields {
        if is_given && !modes.contains(&job.mode) {
            return refuse(format!("{field}: {} takes none", job.mode.name()));
        }
    }
    Ok(())
}

fn check_parameters(job: &Job) -> Result<(), Failure> {
    match (job.mode, &job.params) {
        (Mode::Render, _) => Ok(()),
        (Mode::Forward, Some(Keys::Tangents(tangents))) if !tangents.0.is_empty() => Ok(()),
        (Mode::Forward, _) => {
            refuse("params: forward needs tangents, as in {\"ball.translation\": [1, 0, 0]}")
        }
        (Mode::Backward, Some(Keys::Names(names))) if !names.is_empty() => Ok(()),
        (Mode::Backward, _) => {
            refuse("params: backward needs a list of keys, as in [\"ball.translation\"]")
        }
    }
}

/// Of a backward job: one number.
fn check_objective(job: &Job) -> Result<(), Failure> {
    match (&job.adjoint, &job.target, job.loss) {
        (Some(_), None, None) | (None, Some(_), _) => {}
        (Some(_), None, Some(_)) => {
            return refuse("loss: it belongs to a target, not to an adjoint");
        }
        (Some(_), Some(_), _) => return refuse("give either an adjoint or a target"),
        (None, None, _) => return refuse("backward needs an adjoint or a target"),
    }
    Ok(())
}

fn check_outputs(job: &Job) -> Result<(), Failure> {
    let names_errors = job.outputs.iter().flatten().any(|name| name == STDERR);
    if names_errors && job.stderr == Some(false) {
        return refuse(format!(
            "outputs: {STDERR} is asked for, and \"stderr\": false leaves it out"
        ));
    }
    let known = job.mode.files();
    let mut names = job.outputs.iter().flatten();
    match names.find(|name| !known.contains(&name.as_str())) {
        Some(name) => refuse(format!(
            "outputs: {} writes no \"{name}\"; it writes {}",
            job.mode.name(),
            known.join(", ")
        )),
        None => Ok(()),
    }
}
