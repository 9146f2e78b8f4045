//! Named gradients: safetensors for machine learning, npz for NumPy.

use super::error::FileError;
use super::{atomic, npy};
use crate::files::Regular;
use safetensors::tensor::{Dtype, Metadata, TensorInfo, TensorView};
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
    // No metadata: it would be written in the order of a hash map, and equal runs must give equal
    // bytes.
    let file = views
        .and_then(|views| safetensors::serialize(views, None))
        .map_err(|error| FileError::io(path, error))?;
    atomic::write(path, |writer| writer.write_all(&file))
}

/// A `.safetensors` file of which the header has been read.
pub struct TensorFile {
    path: PathBuf,
    file: Regular,
    metadata: Metadata,
    /// All that comes before the tensors.
    header_bytes: u64,
}

/// One tensor of a file, not yet read.
pub struct Entry<'a> {
    of: &'a TensorFile,
    name: &'a str,
    info: &'a TensorInfo,
    /// Numbers in it.
    count: usize,
}

/// The length of the header stands before it.
const LENGTH_BYTES: u64 = 8;

impl TensorFile {
    /// Opens a file.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let unread = |error| FileError::unread(path, &error);
        let wrong = |what: &str| {
            let what = format!("not a readable .safetensors file: {what}");
            FileError::contents(path, what)
        };
        let file = Regular::open(path).map_err(unread)?;
        let length = file.start(LENGTH_BYTES).map_err(unread)?;
        let length = <[u8; 8]>::try_from(length).map(u64::from_le_bytes);
        let header_bytes = length.ok().and_then(|l| l.checked_add(LENGTH_BYTES));
        let Some(header_bytes) = header_bytes.filter(|bytes| *bytes <= file.bytes()) else {
            return Err(wrong("it is shorter than its header says"));
        };
        let header = file.start(header_bytes).map_err(unread)?;
        let metadata: Metadata = serde_json::from_slice(&header[LENGTH_BYTES as usize..])
            .map_err(|error| wrong(&format!("its header: {error}")))?;
        if header_bytes.checked_add(metadata.data_len() as u64) != Some(file.bytes()) {
            return Err(wrong("its length is not what its header says"));
        }
        Ok(Self {
            path: path.into(),
            file,
            metadata,
            header_bytes,
        })
    }

    /// The tensor of this name, if it holds 32- or 64-bit floats.
    pub fn entry<'a>(&'a self, name: &'a str) -> Result<Entry<'a>, FileError> {
        let wrong = |what: String| FileError::contents(&self.path, what);
        let Some(info) = self.metadata.info(name) else {
            let mut has = self.metadata.offset_keys();
            has.sort_unstable();
            let has = has.join(", ");
            return Err(wrong(format!("no tensor \"{name}\"; it has {has}")));
        };
        let size = match info.dtype {
            Dtype::F32 => 4,
            Dtype::F64 => 8,
            other => return Err(wrong(format!("its numbers are {other:?}; use F32 or F64"))),
        };
        let numbers = info
            .shape
            .iter()
            .try_fold(1usize, |product, &n| product.checked_mul(n));
        let (start, end) = info.data_offsets;
        match numbers {
            Some(count) if count.checked_mul(size) == end.checked_sub(start) => Ok(Entry {
                of: self,
                name,
                info,
                count,
            }),
            _ => Err(wrong(format!(
                "tensor \"{name}\": bytes {start} to {end} are not what shape {} needs",
                npy::tuple(&info.shape)
            ))),
        }
    }

    /// The tensor of this name, as 32-bit floats.
    pub fn get(&self, name: &str) -> Result<Tensor, FileError> {
        self.entry(name)?.read()
    }
}

impl Entry<'_> {
    /// Of the tensor.
    pub fn shape(&self) -> &[usize] {
        &self.info.shape
    }

    /// What reading the numbers takes in memory.
    pub fn bytes_needed(&self) -> u64 {
        4 * self.count as u64
    }

    /// Reads the numbers, as 32-bit floats.
    pub fn read(&self) -> Result<Tensor, FileError> {
        let start = self.of.header_bytes + self.info.data_offsets.0 as u64;
        let values = self
            .of
            .file
            .from(start)
            .and_then(|from| match self.info.dtype {
                Dtype::F64 => npy::floats(from, self.count, |b| f64::from_le_bytes(b) as f32),
                _ => npy::floats(from, self.count, f32::from_le_bytes),
            });
        Ok(Tensor {
            name: self.name.into(),
            shape: self.info.shape.clone(),
            values: values.map_err(|error| FileError::unread(&self.of.path, &error))?,
        })
    }
}

/// Writes the tensors as one uncompressed `.npz` archive, without dates so that equal runs give
/// equal bytes.
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
