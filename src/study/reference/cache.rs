//! References that were made already, by a hash of all they depend on.

use super::rungs::Rungs;
use crate::output::{FileError, atomic, npy};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

fn names(folder: &Path, key: u64) -> [PathBuf; 2] {
    ["npy", "txt"].map(|extension| folder.join(format!("{key:016x}.{extension}")))
}

/// The runs of this key; anything that is not whole counts as not there.
pub fn read(folder: &Path, key: u64, shape: [usize; 3]) -> Option<Rungs> {
    let [numbers, mark] = names(folder, key);
    let brightest: f64 = fs::read_to_string(mark).ok()?.trim().parse().ok()?;
    let array = npy::read(&numbers).ok()?;
    if array.shape != shape {
        return None;
    }
    let [_, runs, length] = shape;
    let step = |numbers: &[f32]| numbers.chunks_exact(length).map(<[f32]>::to_vec).collect();
    Some(Rungs {
        steps: array.values.chunks_exact(runs * length).map(step).collect(),
        brightest,
    })
}

/// Writes them, the small file last: it says that the other is whole.
pub fn write(folder: &Path, key: u64, shape: [usize; 3], rungs: &Rungs) -> Result<(), FileError> {
    atomic::prepare_directory(folder)?;
    let [numbers, mark] = names(folder, key);
    npy::write(
        &numbers,
        &shape,
        rungs.steps.iter().flatten().flatten().copied(),
    )?;
    let text = format!("{:?}\n", rungs.brightest);
    atomic::write(&mark, |file| file.write_all(text.as_bytes()))
}
