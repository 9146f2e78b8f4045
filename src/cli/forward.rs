//! `warpath forward`: the gradient image along one direction.

use super::arguments::ForwardArguments;
use super::exit::Failure;
use super::session::{self, Session};
use super::{comparison, direction};
use crate::methods;
use crate::output::{chart, exr, npy};
use serde_json::json;
use std::ffi::OsString;

/// Writes the gradient image in every format, its standard error, and the image.
pub fn run(arguments: &ForwardArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(arguments.method)?;
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
    if direction
        .iter()
        .all(|(_, tangent)| tangent.iter().all(|value| *value == 0.0))
    {
        session.warn("the tangent is zero, and so is the gradient".into());
    }
    let settings = session.settings.clone();
    let done = session.trace(
        "forward",
        &settings,
        |scene, settings, progress| methods::forward(scene, settings, &direction, progress),
        |forward| &forward.statistics,
    )?;
    session.write("gradient.exr", |path| exr::write(path, &done.gradient))?;
    session.write("gradient.npy", |path| {
        npy::write_image(path, &done.gradient)
    })?;
    session.write("gradient.png", |path| {
        chart::write(path, &done.gradient, chart::robust_scale(&done.gradient))
    })?;
    session.report.results.insert(
        "gradient_rms".into(),
        json!(comparison::rms(&done.gradient)),
    );
    match &done.stderr {
        Some(stderr) => {
            session.write("stderr.npy", |path| npy::write_image(path, stderr))?;
            session
                .report
                .results
                .insert("stderr_rms".into(), json!(comparison::rms(stderr)));
        }
        None => session.warn_of_leftover("stderr.npy"),
    }
    session.write("image.exr", |path| exr::write(path, &done.image))?;
    session.close()
}
