//! How large a picture is, before it is decoded.

use super::format::Format;
use super::pfm;
use image::ImageDecoder;
use image::codecs::{
    bmp::BmpDecoder, hdr::HdrDecoder, jpeg::JpegDecoder, png::PngDecoder, tga::TgaDecoder,
};
use std::io::Cursor;

/// Width and height in texels of a picture whose file begins with `bytes`; `None` if they do not
/// say, or are broken: decoding tells what is wrong with them.
pub fn size_of(bytes: &[u8]) -> Option<[u32; 2]> {
    let from = Cursor::new(bytes);
    let (width, height) = match Format::of(bytes)? {
        Format::Png => PngDecoder::new(from).ok()?.dimensions(),
        Format::Jpeg => JpegDecoder::new(from).ok()?.dimensions(),
        Format::Hdr => HdrDecoder::new_nonstrict(from).ok()?.dimensions(),
        Format::Bmp => BmpDecoder::new(from).ok()?.dimensions(),
        Format::Tga => TgaDecoder::new(from).ok()?.dimensions(),
        Format::Exr => {
            let read = exr::meta::MetaData::read_from_buffered(from, false).ok()?;
            let sizes = read.headers.iter().map(|header| header.layer_size);
            let largest = sizes.max_by_key(|size| size.area())?;
            (largest.width() as u32, largest.height() as u32)
        }
        Format::Pfm => {
            let mut rest = bytes;
            return pfm::header(&mut rest).ok().map(|(_, size)| size);
        }
    };
    Some([width, height])
}
