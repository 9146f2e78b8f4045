//! Named gradients: safetensors for machine learning, npz for NumPy.

use super::{FileError, atomic, npy};
use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use std::io::{self, Cursor, Write};
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

/// One array under a name.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensor {
    pub name: String,
    pub shape: Vec<usize>,
    pub values: Vec<f32>,
}

/// Writes the tensors as one `.safetensors` file.
pub fn write_safetensors(path: &Path, tensors: &[Tensor]) -> Result<(), FileError> {
    let bytes: Vec<Vec<u8>> = tensors
        .iter()
        .map(|t| t.values.iter().flat_map(|v| v.to_le_bytes()).collect())
        .collect();
    let views = tensors
        .iter()
        .zip(&bytes)
        .map(|(tensor, bytes)| {
            Ok((
                tensor.name.as_str(),
                TensorView::new(Dtype::F32, tensor.shape.clone(), bytes)?,
            ))
        })
        .collect::<Result<Vec<_>, safetensors::SafeTensorError>>();
    // No metadata: it would be written in the order of a hash map, and equal runs must give equal bytes.
    let file = views
        .and_then(|views| safetensors::serialize(views, None))
        .map_err(|error| FileError::io(path, error))?;
    atomic::write(path, |writer| writer.write_all(&file))
}

/// A `.safetensors` file in memory.
pub struct Tensors {
    path: PathBuf,
    bytes: Vec<u8>,
}

impl Tensors {
    /// Reads a file.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let bytes = std::fs::read(path)
            .map_err(|error| FileError::contents(path, atomic::plain(&error)))?;
        let path = path.to_path_buf();
        Ok(Self { path, bytes })
    }

    /// The tensor of this name, as 32-bit floats.
    pub fn get(&self, name: &str) -> Result<Tensor, FileError> {
        let wrong = |what: String| FileError::contents(&self.path, what);
        let file = SafeTensors::deserialize(&self.bytes)
            .map_err(|error| wrong(format!("not a readable .safetensors file: {error}")))?;
        let Ok(view) = file.tensor(name) else {
            let mut has: Vec<&str> = file.names();
            has.sort_unstable();
            let has = has.join(", ");
            return Err(wrong(format!("no tensor \"{name}\"; it has {has}")));
        };
        let values = match view.dtype() {
            Dtype::F32 => {
                let parts = view.data().as_chunks::<4>().0.iter();
                parts.map(|part| f32::from_le_bytes(*part)).collect()
            }
            Dtype::F64 => {
                let parts = view.data().as_chunks::<8>().0.iter();
                parts.map(|part| f64::from_le_bytes(*part) as f32).collect()
            }
            other => return Err(wrong(format!("its numbers are {other:?}; use F32 or F64"))),
        };
        Ok(Tensor {
            name: name.into(),
            shape: view.shape().to_vec(),
            values,
        })
    }
}

/// Writes the tensors as one uncompressed `.npz` archive, without dates so that equal runs give equal bytes.
pub fn write_npz(path: &Path, tensors: &[Tensor]) -> Result<(), FileError> {
    let file = npz(tensors).map_err(|error| FileError::io(path, error))?;
    atomic::write(path, |writer| writer.write_all(&file))
}

fn npz(tensors: &[Tensor]) -> io::Result<Vec<u8>> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Stored)
        .last_modified_time(DateTime::default());
    for tensor in tensors {
        archive.start_file(format!("{}.npy", tensor.name), options)?;
        npy::encode(&mut archive, &tensor.shape, tensor.values.iter().copied())?;
    }
    Ok(archive.finish()?.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_formats_give_back_what_was_written() {
        let directory = tempfile::tempdir().unwrap();
        let tensors = [
            Tensor {
                name: "b.translation".into(),
                shape: vec![3],
                values: vec![1., 2., 3.],
            },
            Tensor {
                name: "a.vertex_positions#se".into(),
                shape: vec![2, 3],
                values: vec![0.5; 6],
            },
            Tensor {
                name: "a.scale".into(),
                shape: vec![],
                values: vec![-1.],
            },
        ];
        let path = directory.path().join("g.safetensors");
        write_safetensors(&path, &tensors).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let read = safetensors::SafeTensors::deserialize(&bytes).unwrap();
        assert_eq!(read.tensor("b.translation").unwrap().shape(), [3]);
        assert_eq!(
            read.tensor("a.vertex_positions#se").unwrap().data()[..4],
            0.5f32.to_le_bytes()
        );

        let path = directory.path().join("g.npz");
        write_npz(&path, &tensors).unwrap();
        let mut archive = zip::ZipArchive::new(std::fs::File::open(&path).unwrap()).unwrap();
        let mut bytes = Vec::new();
        let mut entry = archive.by_name("a.vertex_positions#se.npy").unwrap();
        std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
        let array = npy::decode(&bytes).unwrap();
        assert_eq!(array.shape, [2, 3]);
        assert_eq!(array.values, vec![0.5; 6]);
        let first = std::fs::read(&path).unwrap();
        write_npz(&path, &tensors).unwrap();
        assert_eq!(first, std::fs::read(&path).unwrap());
    }
}
