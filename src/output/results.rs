//! The files of each kind of result: one list for a command run alone and for a job of a batch.

use super::tensors::{self, Tensor};
use super::{FileError, chart, exr, npy, png};
use crate::methods::{ForwardGradient, Image};
use std::path::Path;

type Write<'a> = dyn Fn(&Path) -> Result<(), FileError> + 'a;

/// A file that is ready to be written.
pub struct ResultFile<'a> {
    /// What it is called in result lines.
    pub key: &'static str,
    /// Its name in the output directory.
    pub name: &'static str,
    write: Box<Write<'a>>,
}

impl<'a> ResultFile<'a> {
    fn new(
        key: &'static str,
        name: &'static str,
        write: impl Fn(&Path) -> Result<(), FileError> + 'a,
    ) -> Self {
        Self {
            key,
            name,
            write: Box::new(write),
        }
    }

    /// Writes it as `path`.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        (self.write)(path)
    }
}

/// Names of the files of `render`, `forward` and `backward`, in the order in which they are written.
pub const RENDER: [&str; 2] = ["image.exr", "image.png"];
pub const FORWARD: [&str; 5] = [
    "gradient.exr",
    "gradient.npy",
    "gradient.png",
    "stderr.npy",
    "image.exr",
];
pub const BACKWARD: [&str; 3] = ["gradients.safetensors", "gradients.npz", "image.exr"];

/// An image.
pub fn rendered(image: &Image) -> Vec<ResultFile<'_>> {
    let [exr_name, png_name] = RENDER;
    vec![
        ResultFile::new("image", exr_name, |path| exr::write(path, image)),
        ResultFile::new("image_png", png_name, |path| png::write_image(path, image)),
    ]
}

/// A gradient image in every format, its standard error if there is one, and the image.
pub fn forward(done: &ForwardGradient) -> Vec<ResultFile<'_>> {
    let [exr_name, npy_name, png_name, stderr_name, image_name] = FORWARD;
    let gradient = &done.gradient;
    let mut files = vec![
        ResultFile::new("gradient_exr", exr_name, |path| exr::write(path, gradient)),
        ResultFile::new("gradient", npy_name, |path| {
            npy::write_image(path, gradient)
        }),
        ResultFile::new("gradient_png", png_name, |path| {
            chart::write(path, gradient, chart::robust_scale(gradient))
        }),
    ];
    if let Some(stderr) = &done.stderr {
        files.push(ResultFile::new("stderr", stderr_name, |path| {
            npy::write_image(path, stderr)
        }));
    }
    files.push(ResultFile::new("image", image_name, |path| {
        exr::write(path, &done.image)
    }));
    files
}

/// One tensor a key in both formats, and the image.
pub fn backward<'a>(gradients: &'a [Tensor], image: &'a Image) -> Vec<ResultFile<'a>> {
    let [safetensors_name, npz_name, image_name] = BACKWARD;
    vec![
        ResultFile::new("gradients", safetensors_name, |path| {
            tensors::write_safetensors(path, gradients)
        }),
        ResultFile::new("gradients_npz", npz_name, |path| {
            tensors::write_npz(path, gradients)
        }),
        ResultFile::new("image", image_name, |path| exr::write(path, image)),
    ]
}

/// Tensors that are no results yet.
pub fn partial<'a>(name: &'static str, tensors: &'a [Tensor]) -> ResultFile<'a> {
    ResultFile::new("partial", name, |path| {
        tensors::write_safetensors(path, tensors)
    })
}
