//! The numbers of a parameter, typed in or in a file.

use super::failure::Failure;
use super::number_file::{NumberFile, misshapen};
use crate::scene::parameters::Parameter;
use std::path::PathBuf;

/// Numbers of a parameter, not yet compared with any scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Numbers {
    /// All of them row by row; lists of lists have a shape of several axes, a number alone has
    /// none.
    Inline { values: Vec<f32>, shape: Vec<usize> },
    /// A `.npy`, or a `.safetensors` with a tensor of the parameter's key.
    File(PathBuf),
}

impl Numbers {
    /// A list.
    pub fn list(values: Vec<f32>) -> Self {
        let shape = vec![values.len()];
        Self::Inline { values, shape }
    }

    /// As many numbers as the parameter has. What is typed in may be one row, which then holds for
    /// all rows.
    pub fn of_all_rows(&self, parameter: &Parameter, key: &str) -> Result<Vec<f32>, Failure> {
        match self {
            Numbers::Inline { values, shape } if shape.len() < 2 => {
                Ok(parameter.broadcast(values)?)
            }
            _ => self.exactly(parameter, key),
        }
    }

    /// As many numbers as the parameter has, all of them given. `key` is what it was called.
    pub fn exactly(&self, parameter: &Parameter, key: &str) -> Result<Vec<f32>, Failure> {
        let (name, values) = match self {
            Numbers::Inline { values, shape } => {
                let fits = match shape.len() {
                    0 | 1 => values.len() == parameter.len(),
                    _ => *shape == parameter.shape,
                };
                if !fits {
                    return Err(misshapen(key, shape, parameter));
                }
                (key.to_string(), values.clone())
            }
            Numbers::File(path) => {
                let values = NumberFile::open(path, parameter, key)?.read(parameter, key)?;
                (path.display().to_string(), values)
            }
        };
        match values.iter().position(|value| !value.is_finite()) {
            None => Ok(values),
            Some(at) => Err(Failure::Input(format!("{name}: number {at} is not finite"))),
        }
    }

    /// What reading them takes in memory. A file that has not the parameter's shape is refused.
    pub fn bytes_needed(&self, parameter: &Parameter, key: &str) -> Result<u64, Failure> {
        match self {
            Numbers::Inline { .. } => Ok(0),
            Numbers::File(path) => Ok(NumberFile::open(path, parameter, key)?.bytes_needed),
        }
    }
}
