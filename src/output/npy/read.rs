//! Arrays of 32- and 64-bit floats and integers, of either byte and axis order; what the header
//! says is known before the numbers are read.

use super::super::error::FileError;
use super::shape;
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
        let array = numbers.and_then(|numbers| self.header.numbers(numbers));
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
    let numbers = &bytes[header.bytes as usize..];
    header.numbers(numbers).map_err(|error| error.to_string())
}

#[derive(Debug)]
struct Header {
    kind: String,
    big_endian: bool,
    fortran: bool,
    shape: Vec<usize>,
    /// The product of the shape.
    count: usize,
    /// All that comes before the numbers.
    bytes: u64,
}

impl Header {
    /// How long it is with all that is before it, given how the file begins.
    fn length(start: &[u8]) -> Result<u64, String> {
        let body = start
            .strip_prefix(b"\x93NUMPY")
            .ok_or("not a NumPy array (.npy)")?;
        match body {
            [1, _, a, b, ..] => Ok(10 + u64::from(u16::from_le_bytes([*a, *b]))),
            [2 | 3, _, a, b, c, d, ..] => Ok(12 + u64::from(u32::from_le_bytes([*a, *b, *c, *d]))),
            _ => Err("a NumPy file version that is not known".into()),
        }
    }

    /// Reads it where a file of `file_bytes` starts.
    fn parse(start: &[u8], file_bytes: u64) -> Result<Self, String> {
        let bytes = Self::length(start)?;
        let before = if start[6] == 1 { 10 } else { 12 };
        let text = usize::try_from(bytes)
            .ok()
            .and_then(|end| start.get(before..end))
            .ok_or("its header ends too early")?;
        let text = std::str::from_utf8(text).map_err(|_| "its header is not text")?;
        let after = |key: &str| {
            text.split_once(&format!("'{key}':"))
                .map(|(_, rest)| rest.trim_start())
                .ok_or(format!("its header has no '{key}'"))
        };
        let quoted = after("descr")?
            .strip_prefix('\'')
            .and_then(|rest| rest.split_once('\''));
        let descr = quoted
            .map(|(descr, _)| descr)
            .ok_or("structured arrays are not read")?;
        let kind = descr.trim_start_matches(['<', '>', '=', '|']).to_string();
        let order = after("fortran_order")?;
        let tuple = after("shape")?
            .strip_prefix('(')
            .and_then(|rest| rest.split_once(')'));
        let numbers = tuple
            .map(|(inside, _)| inside)
            .ok_or("its shape is not a tuple")?;
        let shape = numbers
            .split(',')
            .map(str::trim)
            .filter(|n| !n.is_empty())
            .map(str::parse)
            .collect::<Result<Vec<usize>, _>>();
        let shape =
            shape.map_err(|_| format!("its shape ({numbers}) is not made of whole numbers"))?;
        let size = match kind.as_str() {
            "f4" | "i4" => 4,
            "f8" | "i8" => 8,
            other => {
                return Err(format!(
                    "its type '{other}' is not read; use float32 or float64"
                ));
            }
        };
        let count = shape
            .iter()
            .try_fold(1usize, |product, &n| product.checked_mul(n));
        let data = file_bytes.saturating_sub(bytes);
        match count {
            Some(count) if count.checked_mul(size).map(|b| b as u64) == Some(data) => Ok(Self {
                kind,
                big_endian: descr.starts_with('>'),
                fortran: order.starts_with("True"),
                shape,
                count,
                bytes,
            }),
            _ => Err(format!(
                "its {data} bytes of data are not what shape {} needs",
                shape::tuple(&shape)
            )),
        }
    }

    /// The array whose numbers `from` gives.
    fn numbers(&self, from: impl Read) -> io::Result<Array> {
        let values = match self.kind.as_str() {
            "f4" => self.decode(from, f32::from_le_bytes),
            "f8" => self.decode(from, |b| f64::from_le_bytes(b) as f32),
            "i4" => self.decode(from, |b| i32::from_le_bytes(b) as f32),
            _ => self.decode(from, |b| i64::from_le_bytes(b) as f32),
        }?;
        Ok(Array {
            values: match self.fortran {
                true => transposed(&values, &self.shape)?,
                false => values,
            },
            shape: self.shape.clone(),
        })
    }

    fn decode<const N: usize>(
        &self,
        from: impl Read,
        number: impl Fn([u8; N]) -> f32,
    ) -> io::Result<Vec<f32>> {
        floats(from, self.count, |mut bytes| {
            if self.big_endian {
                bytes.reverse();
            }
            number(bytes)
        })
    }
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
