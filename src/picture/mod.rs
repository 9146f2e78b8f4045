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
mod jpeg_end;
#[cfg(feature = "oiio")]
pub mod oiio;
mod pfm;
mod png_jpeg_hdr;
mod size;
mod srgb;

pub use error::PictureError;
pub use header::size_of;
pub use srgb::srgb_to_linear;

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

/// Reads a picture file.
///
/// # Errors
///
/// One sentence that names the file, if it is not there or is no picture in a known format, if it is
/// broken, ends too early or is absurdly large, or if a texel is not finite.
pub fn read(file: &Path, colours: Colours) -> Result<Picture, PictureError> {
    decode(&error::read_file(file)?, file, colours)
}

/// As [`read`], but the `bytes` of `file` have been read already. The file's name is for errors; and for
/// OpenImageIO, which opens it anew.
///
/// # Errors
///
/// Those of [`read`].
pub fn decode(bytes: &[u8], file: &Path, colours: Colours) -> Result<Picture, PictureError> {
    if bytes.is_empty() {
        return Err(PictureError::contents(file, "the file is empty"));
    }
    let picture = match Format::of(bytes) {
        Some(Format::Exr) => exr::decode(bytes),
        Some(Format::Png) => png_jpeg_hdr::png(bytes, colours),
        Some(Format::Jpeg) => png_jpeg_hdr::jpeg(bytes, colours),
        Some(Format::Hdr) => png_jpeg_hdr::hdr(bytes),
        Some(Format::Pfm) => pfm::decode(bytes),
        #[cfg(feature = "oiio")]
        None => return oiio::read(file, colours),
        #[cfg(not(feature = "oiio"))]
        None => Err(format::unknown(file)),
    };
    picture
        .and_then(Picture::all_finite)
        .map_err(|what| PictureError::contents(file, what))
}

impl Picture {
    /// The picture itself, or where it is not finite.
    fn all_finite(self) -> Result<Self, String> {
        let is_bad = |texel: &[f32; 3]| texel.iter().any(|v| !v.is_finite());
        match self.pixels.iter().position(is_bad) {
            None => Ok(self),
            Some(at) => {
                let width = self.width as usize;
                let (x, y) = (at % width, at / width);
                Err(format!("the texel at x {x}, y {y} is not finite"))
            }
        }
    }
}
