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
pub fn resolve(scene: &Scene, tangents: &[Tangent]) -> Result<Direction, Failure> {
    let keys: Vec<&str> = tangents
        .iter()
        .map(|tangent| tangent.key.as_str())
        .collect();
    let found = find(scene, &keys)?;
    found
        .into_iter()
        .zip(tangents)
        .map(|(parameter, tangent)| {
            let values = match &tangent.value {
                TangentValue::Numbers(numbers) => broadcast(&parameter, numbers)?,
                TangentValue::File(path) => from_file(&parameter, path)?,
            };
            Ok((parameter, values))
        })
        .collect()
}

/// Finds parameters that can be differentiated. Two names of the same one are a mistake.
pub fn find(scene: &Scene, keys: &[&str]) -> Result<Vec<Parameter>, Failure> {
    let mut found: Vec<Parameter> = Vec::with_capacity(keys.len());
    for key in keys {
        let parameter =
            parameters::find(scene, key).map_err(|error| Failure::Input(error.to_string()))?;
        if !parameter.differentiable {
            return Err(Failure::Input(format!("{key} cannot be differentiated")));
        }
        if found.iter().any(|other| other.key == parameter.key) {
            return Err(Failure::Input(format!("{} is given twice", parameter.key)));
        }
        found.push(parameter);
    }
    Ok(found)
}

/// One number goes everywhere; as many as the last axis has go to every row.
fn broadcast(parameter: &Parameter, numbers: &[f32]) -> Result<Vec<f32>, Failure> {
    let count: usize = parameter.shape.iter().product();
    let row = parameter.shape.last().copied().unwrap_or(1);
    if numbers.len() != 1 && numbers.len() != row {
        let wanted = if row == 1 {
            "1 number".into()
        } else {
            format!("1 or {row} numbers")
        };
        return Err(Failure::Input(format!(
            "{}: the tangent has {} numbers; the shape is {}: give {wanted}, or @file.npy",
            parameter.key,
            numbers.len(),
            npy::tuple(&parameter.shape),
        )));
    }
    Ok(numbers.iter().copied().cycle().take(count).collect())
}

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
