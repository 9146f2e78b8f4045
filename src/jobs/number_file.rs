//! A file with the numbers of a parameter.

use super::failure::Failure;
use crate::output::FileError;
use crate::output::npy::{self, ArrayFile};
use crate::output::tensors::{Entry, TensorFile};
use crate::scene::parameters::Parameter;
use std::path::Path;

/// A file with the numbers of a parameter, which has its shape.
pub struct NumberFile {
    kind: FileKind,
    /// What reading them takes in memory.
    pub bytes_needed: u64,
}

enum FileKind {
    Array(ArrayFile),
    Tensors(TensorFile),
}

impl NumberFile {
    /// Reads the header and compares it with the parameter.
    pub fn open(path: &Path, parameter: &Parameter, key: &str) -> Result<Self, Failure> {
        let is_tensors = path
            .extension()
            .is_some_and(|extension| extension.eq_ignore_ascii_case("safetensors"));
        let (kind, shape, bytes_needed) = if is_tensors {
            let file = TensorFile::open(path)?;
            let entry = entry(&file, parameter, key)?;
            let (shape, bytes) = (entry.shape().to_vec(), entry.bytes_needed());
            (FileKind::Tensors(file), shape, bytes)
        } else {
            let file = ArrayFile::open(path)?;
            let (shape, bytes) = (file.shape().to_vec(), file.bytes_needed());
            (FileKind::Array(file), shape, bytes)
        };
        if shape != parameter.shape {
            return Err(misshapen(&path.display().to_string(), &shape, parameter));
        }
        Ok(Self { kind, bytes_needed })
    }

    /// Reads the numbers.
    pub fn read(self, parameter: &Parameter, key: &str) -> Result<Vec<f32>, Failure> {
        match self.kind {
            FileKind::Array(file) => Ok(file.read()?.values),
            FileKind::Tensors(file) => Ok(entry(&file, parameter, key)?.read()?.values),
        }
    }
}

/// The parameter's tensor, under the name it was called or its own.
fn entry<'a>(
    file: &'a TensorFile,
    parameter: &'a Parameter,
    key: &'a str,
) -> Result<Entry<'a>, FileError> {
    file.entry(key).or_else(|_| file.entry(&parameter.key))
}

/// Says which shape the numbers have, and which they should have.
pub fn misshapen(name: &str, shape: &[usize], parameter: &Parameter) -> Failure {
    Failure::Input(format!(
        "{name}: the shape is {}, {} has {}",
        npy::tuple(shape),
        parameter.key,
        npy::tuple(&parameter.shape),
    ))
}
