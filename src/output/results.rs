//! The files of each kind of result: one list for a command run alone and for a job of a batch.

use super::error::FileError;
use super::tensors::{self, Tensor};
use super::{chart, exr, npy, png};
use crate::methods::ForwardGradient;
use crate::picture::Image;
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

/// A result that single precision cannot hold: it must reach no file.
#[derive(Debug, thiserror::Error)]
#[error(
    "{what} is not finite: numbers of this scene, or of what is asked of it, are beyond what single precision \
     holds (3.4e38); scale its lengths or its light"
)]
pub struct NotFinite {
    what: String,
}

/// Refuses an image with a number that is not finite.
pub fn check_image(name: &str, image: &Image) -> Result<(), NotFinite> {
    let is_bad = |pixel: &[f32; 3]| pixel.iter().any(|v| !v.is_finite());
    match image.pixels.iter().position(is_bad) {
        None => Ok(()),
        Some(at) => {
            let (x, y) = (at % image.width, at / image.width);
            Err(NotFinite {
                what: format!("the {name} at pixel x {x}, y {y}"),
            })
        }
    }
}

fn check_tensors(tensors: &[Tensor]) -> Result<(), NotFinite> {
    let bad = |t: &Tensor| t.values.iter().any(|v| !v.is_finite());
    match tensors.iter().find(|t| bad(t)) {
        None => Ok(()),
        Some(tensor) => Err(NotFinite {
            what: tensor.name.clone(),
        }),
    }
}

/// The image as an array, for programs: written by jobs that ask for it by name, and no others.
const ON_REQUEST: &str = "image.npy";

/// Whether a file is to be written, given the names that a job asks for, if it names any.
pub fn is_wanted(name: &str, asked_for: Option<&[String]>) -> bool {
    asked_for.map_or(name != ON_REQUEST, |names| names.iter().any(|n| n == name))
}

/// Standard errors of a gradient image, written if there are any.
pub const STDERR: &str = "stderr.npy";

/// Names of the files of `render`, `forward` and `backward`, in the order in which they are
/// written.
pub const RENDER: [&str; 3] = ["image.exr", "image.png", ON_REQUEST];
pub const FORWARD: [&str; 5] = [
    "gradient.exr",
    "gradient.npy",
    "gradient.png",
    STDERR,
    "image.exr",
];
pub const BACKWARD: [&str; 3] = ["gradients.safetensors", "gradients.npz", "image.exr"];

/// An image.
pub fn rendered(image: &Image) -> Result<Vec<ResultFile<'_>>, NotFinite> {
    check_image("image", image)?;
    let [exr_name, png_name, npy_name] = RENDER;
    Ok(vec![
        ResultFile::new("image", exr_name, |path| exr::write(path, image)),
        ResultFile::new("image_png", png_name, |path| png::write_image(path, image)),
        ResultFile::new("image_npy", npy_name, |path| npy::write_image(path, image)),
    ])
}

/// A gradient image in every format, its standard error if there is one, and the image.
pub fn forward(done: &ForwardGradient) -> Result<Vec<ResultFile<'_>>, NotFinite> {
    check_image("gradient", &done.gradient)?;
    check_image("image", &done.image)?;
    if let Some(stderr) = &done.stderr {
        check_image("standard error", stderr)?;
    }
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
    Ok(files)
}

/// One tensor a key in both formats, and the image.
pub fn backward<'a>(
    gradients: &'a [Tensor],
    image: &'a Image,
) -> Result<Vec<ResultFile<'a>>, NotFinite> {
    check_tensors(gradients)?;
    check_image("image", image)?;
    let [safetensors_name, npz_name, image_name] = BACKWARD;
    Ok(vec![
        ResultFile::new("gradients", safetensors_name, |path| {
            tensors::write_safetensors(path, gradients)
        }),
        ResultFile::new("gradients_npz", npz_name, |path| {
            tensors::write_npz(path, gradients)
        }),
        ResultFile::new("image", image_name, |path| exr::write(path, image)),
    ])
}

/// Tensors that are no results yet.
pub fn partial<'a>(name: &'static str, tensors: &'a [Tensor]) -> Result<ResultFile<'a>, NotFinite> {
    check_tensors(tensors)?;
    Ok(ResultFile::new("partial", name, |path| {
        tensors::write_safetensors(path, tensors)
    }))
}
