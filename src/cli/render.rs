//! `warpath render`: the image.

use super::arguments::RenderArguments;
use super::exit::Failure;
use super::session::Session;
use crate::methods;
use crate::output::results;
use std::ffi::OsString;

/// Renders and writes `image.exr` and `image.png`.
pub fn run(arguments: &RenderArguments, typed: &[OsString]) -> Result<(), Failure> {
    let mut session = Session::open("render", &arguments.trace, typed, None, false)?;
    let settings = session.settings.clone();
    let rendering = session.trace("render", &settings, methods::render, |r| &r.statistics)?;
    let mut files = results::rendered(&rendering.image)?;
    files.retain(|file| results::is_wanted(file.name, None));
    for file in files {
        session.write(file.name, |path| file.write(path))?;
    }
    session.close()
}
