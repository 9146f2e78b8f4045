//! From what was typed after `--param` to parameters of the scene and the numbers that move them.

use super::exit::Failure;
use super::values::{Tangent, TangentValue};
use crate::output::npy;
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter};
use std::path::Path;

/// A direction in parameter space: each parameter with one number for every number it has.
pub type Direction = Vec<(Parameter, Vec<f32>)>;

/// Finds the parameters and expands their tangents.
pub fn resolve(scene: &Scene, tangents: &[Tangent], sensor: usize) -> Result<Direction, Failure> {
    let keys: Vec<&str> = tangents
        .iter()
        .map(|tangent| tangent.key.as_str())
        .collect();
    let found = find(scene, &keys, sensor)?;
    found
        .into_iter()
        .zip(tangents)
        .map(|(parameter, tangent)| {
            let values = match &tangent.value {
                TangentValue::Numbers(numbers) => parameter.broadcast(numbers)?,
                TangentValue::File(path) => from_file(&parameter, path)?,
            };
            Ok((parameter, values))
        })
        .collect()
}

/// Finds parameters that sensor `sensor` can be differentiated by. Two names of the same one are a mistake.
pub fn find(scene: &Scene, keys: &[&str], sensor: usize) -> Result<Vec<Parameter>, Failure> {
    let mut found: Vec<Parameter> = Vec::with_capacity(keys.len());
    for key in keys {
        let parameter = parameters::find(scene, key)?;
        parameter.check_sensor(scene, sensor)?;
        if found.iter().any(|other| other.key == parameter.key) {
            return Err(Failure::Input(format!("{} is given twice", parameter.key)));
        }
        found.push(parameter);
    }
    Ok(found)
}

/// A file has the parameter's own shape: what would be broadcast is short enough to be typed.
fn from_file(parameter: &Parameter, path: &Path) -> Result<Vec<f32>, Failure> {
    let array = npy::read(path)?;
    if array.shape != parameter.shape {
        return Err(Failure::Input(format!(
            "{}: the shape is {}, {} has {}",
            path.display(),
            npy::tuple(&array.shape),
            parameter.key,
            npy::tuple(&parameter.shape),
        )));
    }
    if let Some(at) = array.values.iter().position(|value| !value.is_finite()) {
        return Err(Failure::Input(format!(
            "{}: number {at} is not finite",
            path.display()
        )));
    }
    Ok(array.values)
}
