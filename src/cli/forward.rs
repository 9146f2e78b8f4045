//! `warpath forward`: the gradient image along one direction.

use super::arguments::ForwardArguments;
use super::exit::Failure;
use super::session::{self, Session};
use crate::jobs::direction;
use crate::methods;
use crate::output::{gradients, results};
use serde_json::json;
use std::ffi::OsString;

/// Writes the gradient image in every format, its standard error, and the image.
pub fn run(arguments: &ForwardArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(&arguments.method)?;
    let mut session = Session::open(
        "forward",
        &arguments.trace,
        typed,
        Some(method),
        !arguments.no_stderr,
    )?;
    let direction = direction::resolve(
        &session.scene,
        &arguments.parameters,
        session.settings.sensor,
    )?;
    if direction::is_zero(&direction) {
        session.warn("the tangent is zero, and so is the gradient".into());
    }
    session.warn_of_one_group();
    let settings = session.settings.clone();
    let done = session.trace(
        "forward",
        &settings,
        |scene, settings, progress| methods::forward(scene, settings, &direction, progress),
        |forward| &forward.statistics,
    )?;
    for file in results::forward(&done)? {
        session.write(file.name, |path| file.write(path))?;
    }
    let mut found = |key: &str, image| {
        let rms = json!(gradients::rms(image));
        session.report.results.insert(key.into(), rms);
    };
    found("gradient_rms", &done.gradient);
    match &done.stderr {
        Some(stderr) => found("stderr_rms", stderr),
        None => session.warn_of_leftover("stderr.npy"),
    }
    if arguments.explain {
        session.explain();
    }
    session.close()
}
