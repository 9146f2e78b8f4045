//! A user's picture, whatever its format.

use super::error::FileError;
use super::npy::{self, Array, ArrayFile};
use crate::files::{Regular, plain};
use crate::picture::Image;
use crate::picture::{self, ChannelNames, Colours, PictureError, Wanted};
use std::path::{Path, PathBuf};

/// A header is looked for in so many bytes at first.
const START_BYTES: u64 = 1 << 16;

/// A picture of which the header has been read.
pub struct PictureFile {
    path: PathBuf,
    kind: Kind,
    /// Width and height in pixels. Of a file that does not say, or says it in a way that decoding
    /// will refuse, `None`.
    size: Option<[u64; 2]>,
}

enum Kind {
    Array(ArrayFile),
    Picture(Regular),
}

impl PictureFile {
    /// Opens `.npy` (H×W×3, H×W×1 or H×W), or any format of textures.
    pub fn open(path: &Path) -> Result<Self, FileError> {
        let extension = path.extension();
        let (kind, size) = if extension.is_some_and(|e| e.eq_ignore_ascii_case("npy")) {
            let file = ArrayFile::open(path)?;
            let size = match *file.shape() {
                [h, w] | [h, w, 1 | 3] => [w as u64, h as u64],
                ref shape => {
                    let what = format!(
                        "its shape {} is not that of an image, (height, width, 3)",
                        npy::tuple(shape)
                    );
                    return Err(FileError::contents(path, what));
                }
            };
            (Kind::Array(file), Some(size))
        } else {
            let unread = |error| FileError::unread(path, &error);
            let file = Regular::open(path).map_err(unread)?;
            let mut size = picture::size_of(&file.start(START_BYTES).map_err(unread)?);
            if size.is_none() && file.bytes() > START_BYTES {
                size = picture::size_of(&file.all().map_err(unread)?);
            }
            (Kind::Picture(file), size.map(|size| size.map(u64::from)))
        };
        Ok(Self {
            path: path.into(),
            kind,
            size,
        })
    }

    /// Width and height in pixels, if the file says them at its beginning.
    pub fn size(&self) -> Option<[u64; 2]> {
        self.size
    }

    /// What reading the pixels takes in memory.
    pub fn bytes_needed(&self) -> u64 {
        let [width, height] = self.size.unwrap_or_default();
        let pixels = 12 * width.saturating_mul(height);
        match &self.kind {
            Kind::Array(file) => file.bytes_needed() + pixels,
            // As the file stores them, too.
            Kind::Picture(file) => file.bytes() + 2 * pixels,
        }
    }

    /// Reads a linear RGB image. Every number must be finite.
    pub fn read(self) -> Result<Image, FileError> {
        let path = &self.path;
        let image = match self.kind {
            Kind::Array(file) => from_array(file.read()?),
            Kind::Picture(file) => {
                let bytes = file
                    .all()
                    .map_err(|error| FileError::unread(path, &error))?;
                let wanted = Wanted {
                    colours: Colours::Auto,
                    channels: ChannelNames::WithPrefix,
                };
                let picture = picture::decode(&bytes, path, wanted)?;
                Image {
                    width: picture.width as usize,
                    height: picture.height as usize,
                    pixels: picture.pixels,
                }
            }
        };
        match image
            .pixels
            .iter()
            .position(|pixel| pixel.iter().any(|v| !v.is_finite()))
        {
            None => Ok(image),
            Some(at) => {
                let (x, y) = (at % image.width, at / image.width);
                let what = format!("the pixel at x {x}, y {y} is not finite");
                Err(FileError::contents(path, what))
            }
        }
    }
}

impl From<PictureError> for FileError {
    fn from(error: PictureError) -> Self {
        match error {
            PictureError::Contents { file, what } => FileError::contents(file, what),
            PictureError::Io { file, source } => FileError::io(file, plain(&source)),
        }
    }
}

/// Of an array that [`PictureFile::open`] has looked at.
fn from_array(array: Array) -> Image {
    let [height, width] = [array.shape[0], array.shape[1]];
    let pixels = match array.shape[..] {
        [_, _, 3] => array.values.as_chunks::<3>().0.to_vec(),
        _ => array.values.iter().map(|&v| [v; 3]).collect(),
    };
    Image {
        width,
        height,
        pixels,
    }
}
