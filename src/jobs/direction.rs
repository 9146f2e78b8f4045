//! From keys and numbers to parameters of the scene and what moves them.

use super::failure::Failure;
use super::numbers::Numbers;
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter};

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

/// Finds parameters that sensor `sensor` can be differentiated by. Two names of the same one are a
/// mistake.
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
