//! NumPy arrays: little-endian 32-bit floats are written, a little more is read, strictly.

mod header;
mod read;
mod shape;

pub(super) use read::floats;
pub use read::{Array, ArrayFile, decode, read};
pub use shape::tuple;

use super::atomic;
use super::error::FileError;
use crate::picture::Image;
use std::io::{self, Write};
use std::path::Path;

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
