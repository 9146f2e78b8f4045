//! `warpath params`: every parameter, as a table or as JSON.

use super::arguments::ParamsArguments;
use super::exit::Failure;
use super::log::Log;
use super::session;
use crate::output::npy;
use crate::scene::parameters;
use serde_json::json;
use std::io::Write;

/// Prints the list on stdout.
pub fn run(arguments: &ParamsArguments) -> Result<(), Failure> {
    let scene = session::load(&arguments.scene, Log::new(&arguments.talk))?;
    let list = parameters::list(&scene);
    let mut stdout = std::io::stdout().lock();
    if arguments.talk.json {
        let list: Vec<_> = list
            .iter()
            .map(|p| {
                json!({
                    "key": p.key, "shape": p.shape,
                    "differentiable": p.differentiable, "moves_visibility": p.moves_visibility,
                })
            })
            .collect();
        serde_json::to_writer_pretty(&mut stdout, &list).map_err(std::io::Error::from)?;
        writeln!(stdout)?;
    } else {
        for p in &list {
            writeln!(stdout, "{} {}", p.key, npy::tuple(&p.shape))?;
        }
    }
    Ok(stdout.flush()?)
}
