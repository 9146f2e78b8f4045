//! Pictures from files: textures, environment maps, target images.
//!
//! EXR, PNG, JPEG, Radiance HDR and PFM are read by what is built in; with the feature `oiio`, other
//! formats by OpenImageIO. What a file holds decides which, not what it is called.

mod error;
mod exr;
#[cfg(feature = "oiio")]
mod ffi;
mod format;
mod header;
mod image;
mod jpeg_end;
#[cfg(feature = "oiio")]
pub mod oiio;
mod pfm;
mod png_jpeg_hdr;
mod size;
mod srgb;

pub use self::image::Image;
pub use error::PictureError;
pub use header::size_of;
pub use srgb::srgb_to_linear;

use error::Fault;
use format::Format;
use std::path::Path;

/// A picture in memory, of at least one texel, all of them finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// In texels.
    pub width: u32,
    /// In texels.
    pub height: u32,
    /// Red, green and blue, row by row from the top, each from the left: `width · height` of them. Grey
    /// is in all three; alpha is dropped, and colours are not divided or multiplied by it.
    pub pixels: Vec<[f32; 3]>,
    /// How the file stores colours.
    pub encoding: Encoding,
}

/// How a file stores colours, whatever was made of them while reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Integers, taken to be sRGB-encoded. The pixels are linear after [`Colours::Auto`], and as stored
    /// but divided by the largest integer after [`Colours::Raw`].
    Srgb,
    /// Linear numbers, and so are the pixels.
    Linear,
}

/// What to make of stored numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Colours {
    /// They are colours: integers are sRGB-encoded and become linear, floating-point numbers are linear.
    #[default]
    Auto,
    /// They are data, such as normals or roughness: only divided by the largest integer.
    Raw,
}

/// How the channels of an OpenEXR file may be called.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ChannelNames {
    /// R, G and B, or Y.
    #[default]
    Plain,
    /// These, large or small, or `layer.R` and so on, as renderers write them; or a single one of any name.
    WithPrefix,
}

/// What of a file's pixels is wanted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted {
    pub colours: Colours,
    pub channels: ChannelNames,
}

impl From<Colours> for Wanted {
    fn from(colours: Colours) -> Self {
        let channels = ChannelNames::default();
        Self { colours, channels }
    }
}

/// Reads a picture file.
///
/// # Errors
///
/// One sentence that names the file, if it is not there or is no picture in a known format, if it is
/// broken, ends too early or is absurdly large, if a texel is not finite, or if memory does not hold it.
pub fn read(file: &Path, wanted: impl Into<Wanted>) -> Result<Picture, PictureError> {
    decode(&error::read_file(file)?, file, wanted)
}

/// As [`read`], but the `bytes` of `file` have been read already. The file's name is for errors; and for
/// OpenImageIO, which opens it anew.
///
/// # Errors
///
/// Those of [`read`].
pub fn decode(
    bytes: &[u8],
    file: &Path,
    wanted: impl Into<Wanted>,
) -> Result<Picture, PictureError> {
    let Wanted { colours, channels } = wanted.into();
    if bytes.is_empty() {
        return Err(PictureError::contents(file, "the file is empty"));
    }
    let picture = match Format::of(bytes) {
        Some(Format::Exr) => exr::decode(bytes, channels),
        Some(Format::Png) => png_jpeg_hdr::png(bytes, colours),
        Some(Format::Jpeg) => png_jpeg_hdr::jpeg(bytes, colours),
        Some(Format::Hdr) => png_jpeg_hdr::hdr(bytes),
        Some(Format::Pfm) => pfm::decode(bytes),
        #[cfg(feature = "oiio")]
        None => return oiio::read(file, colours),
        #[cfg(not(feature = "oiio"))]
        None => Err(format::unknown(file).into()),
    };
    picture
        .and_then(Picture::all_finite)
        .map_err(|fault| fault.of(file))
}

impl Picture {
    /// The picture itself, or where it is not finite.
    fn all_finite(self) -> Result<Self, Fault> {
        let is_bad = |texel: &[f32; 3]| texel.iter().any(|v| !v.is_finite());
        match self.pixels.iter().position(is_bad) {
            None => Ok(self),
            Some(at) => {
                let width = self.width as usize;
                let (x, y) = (at % width, at / width);
                Err(format!("the texel at x {x}, y {y} is not finite").into())
            }
        }
    }
}
