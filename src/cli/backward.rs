//! `warpath backward`: the gradients of a loss for many parameters in one pass.

use super::arguments::{BackwardArguments, Loss};
use super::exit::Failure;
use super::session::{self, Session};
use super::{comparison, direction};
use crate::methods::{self, BackwardGradient, Image, Method, Objective};
use crate::output::tensors::{self, Tensor};
use crate::output::{exr, picture};
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter};
use serde_json::json;
use std::ffi::OsString;
use std::path::Path;

/// Writes one tensor a key with its standard error, and the image.
pub fn run(arguments: &BackwardArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(arguments.method)?;
    if method == Method::Fd {
        return Err(Failure::Usage(
            "--method fd has no reverse mode; use it with forward, or use check".into(),
        ));
    }
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
        (Some(file), _) | (None, Some(file)) => read_image(file, session.resolution())?,
        (None, None) => return Err(Failure::Usage("give --adjoint or --target".into())),
    };
    let objective = match (&arguments.adjoint, arguments.loss) {
        (Some(_), _) => Objective::Adjoint(&image),
        (None, Loss::L1) => Objective::L1(&image),
        (None, Loss::L2) => Objective::L2(&image),
    };
    let settings = session.settings.clone();
    let done = session.trace(
        "backward",
        &settings,
        |scene, settings, progress| {
            methods::backward(scene, settings, &parameters, &objective, progress)
        },
        |backward| &backward.statistics,
    )?;
    let gradients = gradients(&session.scene, &parameters, &done, settings.standard_error);
    session
        .report
        .results
        .insert("loss".into(), json!(done.loss));
    session
        .report
        .results
        .insert("norms".into(), norms(&gradients));
    session.write("gradients.safetensors", |path| {
        tensors::write_safetensors(path, &gradients)
    })?;
    session.write("gradients.npz", |path| tensors::write_npz(path, &gradients))?;
    session.write("image.exr", |path| exr::write(path, &done.image))?;
    session.close()
}

fn read_image(file: &Path, [width, height]: [u32; 2]) -> Result<Image, Failure> {
    let image = picture::read(file)?;
    if (image.width, image.height) != (width as usize, height as usize) {
        return Err(Failure::Input(format!(
            "{}: {}x{} pixels, the image rendered has {width}x{height}; --resolution changes it",
            file.display(),
            image.width,
            image.height
        )));
    }
    Ok(image)
}

/// The gradient of every parameter, each followed by its standard error if one can be told.
fn gradients(
    scene: &Scene,
    parameters: &[Parameter],
    done: &BackwardGradient,
    standard_error: bool,
) -> Vec<Tensor> {
    let mut tensors = Vec::new();
    for parameter in parameters {
        let values = parameters::reduce(scene, parameter, &done.gradient);
        tensors.push(Tensor {
            name: parameter.key.clone(),
            shape: parameter.shape.clone(),
            values,
        });
        if standard_error && done.groups.len() > 1 {
            // Reduced first: the parts of a sum are not independent within a group.
            let groups: Vec<Vec<f32>> = done
                .groups
                .iter()
                .map(|group| parameters::reduce(scene, parameter, group))
                .collect();
            let values = comparison::standard_error(&groups);
            tensors.push(Tensor {
                name: format!("{}#se", parameter.key),
                shape: parameter.shape.clone(),
                values,
            });
        }
    }
    tensors
}

fn norms(gradients: &[Tensor]) -> serde_json::Value {
    let norm = |values: &[f32]| {
        values
            .iter()
            .map(|v| (*v as f64).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    gradients
        .iter()
        .map(|tensor| (tensor.name.clone(), json!(norm(&tensor.values))))
        .collect::<serde_json::Map<_, _>>()
        .into()
}
