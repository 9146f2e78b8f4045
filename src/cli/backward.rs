//! `warpath backward`: the gradients of a loss for many parameters.

use super::arguments::{BackwardArguments, Loss};
use super::exit::Failure;
use super::session::{self, Session};
use crate::jobs::{direction, pictures};
use crate::methods::{self, Objective};
use crate::output::tensors::Tensor;
use crate::output::{gradients, results};
use serde_json::json;
use std::ffi::OsString;

/// Writes one tensor a key with its standard error, and the image.
pub fn run(arguments: &BackwardArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(&arguments.method)?;
    let mut session = Session::open(
        "backward",
        &arguments.trace,
        typed,
        Some(method),
        !arguments.no_stderr,
    )?;
    let keys: Vec<&str> = arguments.parameters.iter().map(String::as_str).collect();
    let parameters = direction::find(&session.scene, &keys, session.settings.sensor)?;
    let image = match (&arguments.adjoint, &arguments.target) {
        (Some(file), _) | (None, Some(file)) => pictures::image(file, session.resolution())?,
        (None, None) => return Err(Failure::Usage("give --adjoint or --target".into())),
    };
    let objective = match (&arguments.adjoint, arguments.loss) {
        (Some(_), _) => Objective::Adjoint(&image),
        (None, Loss::L1) => Objective::L1(&image),
        (None, Loss::L2) => Objective::L2(&image),
    };
    session.warn_of_one_group();
    let settings = session.settings.clone();
    let done = session.trace(
        "backward",
        &settings,
        |scene, settings, progress| {
            methods::backward(scene, settings, &parameters, &objective, progress)
        },
        |backward| &backward.statistics,
    )?;
    let gradients: Vec<Tensor> = parameters
        .iter()
        .flat_map(|parameter| {
            let groups = gradients::reduced(&session.scene, parameter, &done.groups);
            let (key, shape) = (&parameter.key, &parameter.shape);
            gradients::of_groups(key, shape, &groups, settings.standard_error)
        })
        .collect();
    let norms: serde_json::Map<_, _> = gradients
        .iter()
        .map(|tensor| (tensor.name.clone(), json!(gradients::norm(&tensor.values))))
        .collect();
    let results = &mut session.report.results;
    results.insert("loss".into(), json!(done.loss));
    results.insert("norms".into(), norms.into());
    for file in results::backward(&gradients, &done.image)? {
        session.write(file.name, |path| file.write(path))?;
    }
    if arguments.explain {
        session.explain();
    }
    session.close()
}
