//! Pictures from files: textures, environment maps, target images.
//!
//! EXR, PNG, JPEG, Radiance HDR, PFM, BMP and TGA are read by what is built in; with the feature
//! `oiio`, other formats by OpenImageIO. What a file holds decides which, not what it is called.

mod alpha;
mod decoded;
mod error;
mod exr;
#[cfg(feature = "oiio")]
mod ffi;
mod format;
mod header;
mod image;
mod integers_hdr;
mod jpeg_end;
#[cfg(feature = "oiio")]
pub mod oiio;
mod pfm;
mod size;
mod srgb;
mod wanted;

pub use self::alpha::{Alpha, alpha};
pub use self::image::Image;
pub use decoded::{Encoding, Picture};
pub use error::PictureError;
pub use header::size_of;
pub use srgb::srgb_to_linear;
pub use wanted::{ChannelNames, Colours, Wanted};

use format::Format;
use std::path::Path;

/// Reads a picture file.
///
/// # Errors
///
/// One sentence that names the file, if it is not there or is no picture in a known format, if it
/// is broken, ends too early or is absurdly large, if a texel is not finite, or if memory does not
/// hold it.
pub fn read(file: &Path, wanted: impl Into<Wanted>) -> Result<Picture, PictureError> {
    decode(&error::read_file(file)?, file, wanted)
}

/// As [`read`], but the `bytes` of `file` have been read already. The file's name is for errors;
/// and for OpenImageIO, which opens it anew.
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
        Some(Format::Png) => integers_hdr::png(bytes, colours),
        Some(Format::Jpeg) => integers_hdr::jpeg(bytes, colours),
        Some(Format::Hdr) => integers_hdr::hdr(bytes),
        Some(Format::Pfm) => pfm::decode(bytes),
        Some(Format::Bmp) => integers_hdr::bmp(bytes, colours),
        Some(Format::Tga) => integers_hdr::tga(bytes, colours),
        #[cfg(feature = "oiio")]
        None => return oiio::read(file, colours),
        #[cfg(not(feature = "oiio"))]
        None => Err(format::unknown(file).into()),
    };
    picture
        .and_then(Picture::all_finite)
        .map_err(|fault| fault.of(file))
}
