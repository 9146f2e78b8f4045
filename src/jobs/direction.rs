//! From keys and numbers to parameters of the scene and what moves them.

use super::failure::Failure;
use super::numbers::Numbers;
use crate::scene::parameters::{self, Parameter};
use crate::scene::{Scene, SceneError};

/// A direction in parameter space: each parameter with one number for every number it has.
pub type Direction = Vec<(Parameter, Vec<f32>)>;

/// Finds the parameters and expands their tangents.
pub fn resolve(
    scene: &Scene,
    tangents: &[(String, Numbers)],
    sensor: usize,
) -> Result<Direction, Failure> {
    let keys: Vec<&str> = tangents.iter().map(|(key, _)| key.as_str()).collect();
    let found = find(scene, &keys, sensor)?;
    found
        .into_iter()
        .zip(tangents)
        .map(|(parameter, (key, numbers))| {
            let values = numbers.of_all_rows(&parameter, key)?;
            Ok((parameter, values))
        })
        .collect()
}

/// Whether nothing moves.
pub fn is_zero(direction: &Direction) -> bool {
    let mut all = direction.iter().flat_map(|(_, tangent)| tangent);
    all.all(|value| *value == 0.0)
}

/// Finds parameters that sensor `sensor` can be differentiated by, each under the name that it is
/// asked for by: so are its results named. Two names of the same one are a mistake.
pub fn find(scene: &Scene, keys: &[&str], sensor: usize) -> Result<Vec<Parameter>, Failure> {
    let mut found = distinct(keys.iter().map(|key| parameters::find(scene, key)))?;
    for (parameter, key) in found.iter_mut().zip(keys) {
        parameter.check_sensor(scene, sensor)?;
        parameter.key = (*key).to_owned();
    }
    Ok(found)
}

/// The parameters, none of which may be there twice.
pub fn distinct(
    parameters: impl Iterator<Item = Result<Parameter, SceneError>>,
) -> Result<Vec<Parameter>, Failure> {
    let mut found: Vec<Parameter> = Vec::new();
    for parameter in parameters {
        let parameter = parameter?;
        if found.iter().any(|other| other.key == parameter.key) {
            return Err(Failure::Input(format!("{} is given twice", parameter.key)));
        }
        found.push(parameter);
    }
    Ok(found)
}
