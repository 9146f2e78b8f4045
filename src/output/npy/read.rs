//! Arrays of 32- and 64-bit floats and integers, of either byte and axis order; what the header
//! says is known before the numbers are read.

use super::super::error::FileError;
use super::header::Header;
use crate::files::Regular;
use crate::room::{self, NoRoom};
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What is read of a file at first; longer headers are read again.
const START_BYTES: u64 = 4096;

/// Numbers are turned to floats so many bytes at a time, whatever their size.
const PIECE_BYTES: usize = 1 << 16;

/// A dense array of numbers in C order.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    pub shape: Vec<usize>,
    pub values: Vec<f32>,
}

/// A `.npy` file of which the header has been read.
#[derive(Debug)]
pub struct ArrayFile {
    path: PathBuf,
    file: Regular,
    header: Header,
}

impl ArrayFile {
    /// Opens a file. A header that does not fit what follows it is an error.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let unread = |error| FileError::unread(path, &error);
        let file = Regular::open(path).map_err(unread)?;
        let mut start = file.start(START_BYTES).map_err(unread)?;
        let wrong = |what| FileError::contents(path, what);
        let length = Header::length(&start).map_err(wrong)?;
        if length > start.len() as u64 {
            start = file.start(length).map_err(unread)?;
        }
        let header = Header::parse(&start, file.bytes()).map_err(wrong)?;
        Ok(Self {
            path: path.into(),
            file,
            header,
        })
    }

    /// Of the array.
    pub fn shape(&self) -> &[usize] {
        &self.header.shape
    }

    /// What reading the numbers takes in memory.
    pub fn bytes_needed(&self) -> u64 {
        // In Fortran's order they are copied into ours.
        let copies = if self.header.fortran { 2 } else { 1 };
        copies * 4 * self.header.count as u64
    }

    /// Reads the numbers.
    pub fn read(self) -> Result<Array, FileError> {
        let numbers = self.file.from(self.header.bytes);
        let array = numbers.and_then(|from| numbers_of(&self.header, from));
        array.map_err(|error| FileError::unread(&self.path, &error))
    }
}

/// Reads a whole file.
pub fn read(path: &Path) -> Result<Array, FileError> {
    ArrayFile::open(path)?.read()
}

/// Decodes the bytes of a `.npy` file.
pub fn decode(bytes: &[u8]) -> Result<Array, String> {
    let header = Header::parse(bytes, bytes.len() as u64)?;
    let from = &bytes[header.bytes as usize..];
    numbers_of(&header, from).map_err(|error| error.to_string())
}

/// The array of a header whose numbers `from` gives.
fn numbers_of(header: &Header, from: impl Read) -> io::Result<Array> {
    let values = match header.kind.as_str() {
        "f4" => decode_numbers(header, from, f32::from_le_bytes),
        "f8" => decode_numbers(header, from, |b| f64::from_le_bytes(b) as f32),
        "i4" => decode_numbers(header, from, |b| i32::from_le_bytes(b) as f32),
        _ => decode_numbers(header, from, |b| i64::from_le_bytes(b) as f32),
    }?;
    Ok(Array {
        values: match header.fortran {
            true => transposed(&values, &header.shape)?,
            false => values,
        },
        shape: header.shape.clone(),
    })
}

fn decode_numbers<const N: usize>(
    header: &Header,
    from: impl Read,
    number: impl Fn([u8; N]) -> f32,
) -> io::Result<Vec<f32>> {
    floats(from, header.count, |mut bytes| {
        if header.big_endian {
            bytes.reverse();
        }
        number(bytes)
    })
}

/// `count` numbers of `N` bytes as floats; the bytes are never all in memory.
pub fn floats<const N: usize>(
    mut from: impl Read,
    count: usize,
    number: impl Fn([u8; N]) -> f32,
) -> io::Result<Vec<f32>> {
    let mut values = room::empty(count)?;
    let mut piece = vec![0; PIECE_BYTES.min(count * N)];
    while values.len() < count {
        let bytes = piece.len().min((count - values.len()) * N);
        from.read_exact(&mut piece[..bytes])?;
        let (chunks, _) = piece[..bytes].as_chunks::<N>();
        values.extend(chunks.iter().map(|chunk| number(*chunk)));
    }
    Ok(values)
}

/// Fortran order to C order.
fn transposed(values: &[f32], shape: &[usize]) -> Result<Vec<f32>, NoRoom> {
    let mut ordered = room::empty(values.len())?;
    let mut index = vec![0usize; shape.len()];
    ordered.extend((0..values.len()).map(|_| {
        let mut at = 0;
        for (i, n) in index.iter().zip(shape).rev() {
            at = at * n + i;
        }
        for (i, n) in index.iter_mut().zip(shape).rev() {
            *i += 1;
            if *i < *n {
                break;
            }
            *i = 0;
        }
        values[at]
    }));
    Ok(ordered)
}

#[cfg(test)]
mod tests {
    use super::super::write;
    use super::*;

    fn file(descr: &str, fortran: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let header =
            format!("{{'descr': '{descr}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n");
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((header.len() as u16).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(data);
        bytes
    }

    #[test]
    fn what_is_written_is_read_back() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.npy");
        write(&path, &[2, 3], (0..6).map(|i| i as f32)).unwrap();
        let array = read(&path).unwrap();
        assert_eq!(
            array,
            Array {
                shape: vec![2, 3],
                values: vec![0., 1., 2., 3., 4., 5.]
            }
        );
    }

    #[test]
    fn types_and_orders_are_read() {
        let doubles: Vec<u8> = [1.0f64, 2.0, 3.0, 4.0, 5.0, 6.0]
            .iter()
            .flat_map(|v| v.to_be_bytes())
            .collect();
        let array = decode(&file(">f8", "True", "(2, 3)", &doubles)).unwrap();
        assert_eq!(array.values, vec![1., 3., 5., 2., 4., 6.]);
        let integers: Vec<u8> = [1i64, 0, -3].iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(
            decode(&file("<i8", "False", "(3,)", &integers))
                .unwrap()
                .values,
            vec![1., 0., -3.]
        );
        let scalar = decode(&file("<f4", "False", "()", &1.5f32.to_le_bytes())).unwrap();
        assert_eq!((scalar.shape, scalar.values), (vec![], vec![1.5]));
    }

    #[test]
    fn broken_files_are_refused() {
        for bytes in [
            vec![],
            b"\x93NUMPY".to_vec(),
            b"\x93NUMPY\x01\x00\xff\xff{".to_vec(),
            file("<f4", "False", "(3,)", &[0; 8]),
            file("<f4", "False", "(3,)", &[0; 16]),
            file("<c8", "False", "(1,)", &[0; 8]),
            file(
                "<f4",
                "False",
                "(9223372036854775807, 9223372036854775807)",
                &[],
            ),
            file("<f4", "False", "(-1,)", &[]),
            file("<f4", "False", "3", &[0; 12]),
        ] {
            assert!(decode(&bytes).is_err());
        }
    }
}
