//! NumPy arrays: little-endian 32-bit floats are written, a little more is read, strictly.

use super::{FileError, atomic};
use crate::methods::Image;
use std::io::{self, Write};
use std::path::Path;

/// A dense array of numbers in C order.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    pub shape: Vec<usize>,
    pub values: Vec<f32>,
}

/// Writes `values` as little-endian 32-bit floats in C order.
pub fn write(
    path: &Path,
    shape: &[usize],
    values: impl IntoIterator<Item = f32>,
) -> Result<(), FileError> {
    atomic::write(path, |file| encode(file, shape, values))
}

/// Writes the bytes of a `.npy` file.
pub fn encode(
    file: &mut dyn Write,
    shape: &[usize],
    values: impl IntoIterator<Item = f32>,
) -> io::Result<()> {
    // What precedes the data is padded to a multiple of 64 bytes and ends its line.
    const BEFORE_TEXT: usize = 10;
    let shape = tuple(shape);
    let text = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    let length = (BEFORE_TEXT + text.len() + 1).next_multiple_of(64) - BEFORE_TEXT;
    let in_header = u16::try_from(length).map_err(io::Error::other)?;
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&in_header.to_le_bytes())?;
    file.write_all(format!("{text:width$}\n", width = length - 1).as_bytes())?;
    for value in values {
        file.write_all(&value.to_le_bytes())?;
    }
    Ok(())
}

/// Writes an image as an array of height × width × 3.
pub fn write_image(path: &Path, image: &Image) -> Result<(), FileError> {
    write(
        path,
        &[image.height, image.width, 3],
        image.pixels.iter().flatten().copied(),
    )
}

/// Reads an array of 32- or 64-bit floats or integers, of either byte and axis order.
pub fn read(path: &Path) -> Result<Array, FileError> {
    let bytes =
        std::fs::read(path).map_err(|error| FileError::contents(path, atomic::plain(&error)))?;
    decode(&bytes).map_err(|what| FileError::contents(path, what))
}

/// Decodes the bytes of a `.npy` file.
pub fn decode(bytes: &[u8]) -> Result<Array, String> {
    let body = bytes
        .strip_prefix(b"\x93NUMPY")
        .ok_or("not a NumPy array (.npy)")?;
    let (length, rest) = match body {
        [1, _, a, b, rest @ ..] => (u16::from_le_bytes([*a, *b]) as usize, rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        _ => return Err("a NumPy file version that is not known".into()),
    };
    let text = rest.get(..length).ok_or("its header ends too early")?;
    let data = &rest[length..];
    let text = std::str::from_utf8(text).map_err(|_| "its header is not text")?;
    let header = Header::parse(text)?;
    let values = header.values(data)?;
    Ok(Array {
        values: if header.fortran {
            transposed(&values, &header.shape)
        } else {
            values
        },
        shape: header.shape,
    })
}

struct Header {
    kind: String,
    big_endian: bool,
    fortran: bool,
    shape: Vec<usize>,
}

impl Header {
    fn parse(text: &str) -> Result<Self, String> {
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
        Ok(Self {
            kind,
            big_endian: descr.starts_with('>'),
            fortran: order.starts_with("True"),
            shape: shape
                .map_err(|_| format!("its shape ({numbers}) is not made of whole numbers"))?,
        })
    }

    fn values(&self, data: &[u8]) -> Result<Vec<f32>, String> {
        match self.kind.as_str() {
            "f4" => self.decode(data, f32::from_le_bytes),
            "f8" => self.decode(data, |b| f64::from_le_bytes(b) as f32),
            "i4" => self.decode(data, |b| i32::from_le_bytes(b) as f32),
            "i8" => self.decode(data, |b| i64::from_le_bytes(b) as f32),
            other => Err(format!(
                "its type '{other}' is not read; use float32 or float64"
            )),
        }
    }

    fn decode<const N: usize>(
        &self,
        data: &[u8],
        number: impl Fn([u8; N]) -> f32,
    ) -> Result<Vec<f32>, String> {
        let count = self
            .shape
            .iter()
            .try_fold(1usize, |product, &n| product.checked_mul(n));
        let size = count.and_then(|count| count.checked_mul(N));
        if size != Some(data.len()) {
            return Err(format!(
                "its {} bytes of data are not what shape {} needs",
                data.len(),
                tuple(&self.shape)
            ));
        }
        let (chunks, _) = data.as_chunks::<N>();
        Ok(chunks
            .iter()
            .map(|chunk| {
                let mut chunk = *chunk;
                if self.big_endian {
                    chunk.reverse();
                }
                number(chunk)
            })
            .collect())
    }
}

/// Fortran order to C order.
fn transposed(values: &[f32], shape: &[usize]) -> Vec<f32> {
    let mut index = vec![0usize; shape.len()];
    (0..values.len())
        .map(|_| {
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
        })
        .collect()
}

/// A shape as NumPy prints it.
pub fn tuple(shape: &[usize]) -> String {
    match shape {
        [only] => format!("({only},)"),
        _ => format!(
            "({})",
            shape
                .iter()
                .map(usize::to_string)
                .collect::<Vec<_>>()
                .join(", ")
        ),
    }
}

#[cfg(test)]
mod tests {
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
