//! Gradient images of a study as arrays, from which its pictures are made.

use crate::output::{FileError, atomic, npy};
use crate::picture::Image;
use crate::study::measure::Measured;
use crate::study::reference::Reference;
use crate::study::task::Task;
use std::path::{Path, PathBuf};

/// The folder of a study's gradient images.
pub const FOLDER: &str = "gradients";

/// Of the reference.
pub fn reference_path(directory: &Path, scene: &str, direction: &str) -> PathBuf {
    let name = format!("{scene}-{direction}-reference.npy");
    directory.join(FOLDER).join(name)
}

/// Of the first repeat of a cell.
pub fn path(directory: &Path, scene: &str, direction: &str, method: &str, spp: u32) -> PathBuf {
    let name = format!("{scene}-{direction}-{method}-{spp}.npy");
    directory.join(FOLDER).join(name)
}

/// Writes those of a direction.
pub fn write(
    directory: &Path,
    task: &Task,
    reference: &Reference,
    measured: &Measured,
) -> Result<(), FileError> {
    atomic::prepare_directory(&directory.join(FOLDER))?;
    let (scene, direction) = (&task.plan.name, task.name);
    let [width, height] = task.size;
    let mean = reference.mean.iter().map(|x| *x as f32);
    let shape = [height, width, 3];
    npy::write(&reference_path(directory, scene, direction), &shape, mean)?;
    for (cell, picture) in measured.cells.iter().zip(&measured.pictures) {
        if let Some(picture) = picture {
            let path = path(directory, scene, direction, &cell.method, cell.spp);
            npy::write_image(&path, picture)?;
        }
    }
    Ok(())
}

/// Reads one of them.
pub fn read(path: &Path) -> Result<Image, FileError> {
    crate::output::picture::PictureFile::open(path)?.read()
}
