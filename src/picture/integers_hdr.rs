//! PNG, JPEG, BMP, TGA and Radiance HDR, by the `image` crate.
//!
//! As Mitsuba does, colour profiles, gamma chunks, orientation tags and exposure lines are left
//! alone.

use super::error::Fault;
use super::size::texels;
use super::{Colours, Encoding, Picture, jpeg_end, srgb_to_linear};
use crate::room;
use image::codecs::{
    bmp::BmpDecoder, hdr::HdrDecoder, jpeg::JpegDecoder, png::PngDecoder, tga::TgaDecoder,
};
use image::{ImageDecoder, ImageError, Limits};
use std::error::Error;
use std::io::{self, Cursor};

/// What one row and the texts beside a PNG's pixels may take, in bytes.
const MOST_FOR_PNG_CHUNKS: u64 = 64 << 20;

pub(super) fn png(bytes: &[u8], colours: Colours) -> Result<Picture, Fault> {
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MOST_FOR_PNG_CHUNKS);
    let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits);
    let decoder = decoder.map_err(|error| unreadable("PNG", &error))?;
    Samples::read("PNG", decoder, bytes.len())?.integers(colours)
}

pub(super) fn jpeg(bytes: &[u8], colours: Colours) -> Result<Picture, Fault> {
    if !jpeg_end::is_whole(bytes) {
        return Err("not a readable JPEG picture: it ends too early".into());
    }
    let decoder = JpegDecoder::new(Cursor::new(bytes));
    let decoder = decoder.map_err(|error| unreadable("JPEG", &error))?;
    Samples::read("JPEG", decoder, bytes.len())?.integers(colours)
}

pub(super) fn bmp(bytes: &[u8], colours: Colours) -> Result<Picture, Fault> {
    let decoder = BmpDecoder::new(Cursor::new(bytes));
    let decoder = decoder.map_err(|error| unreadable("BMP", &error))?;
    Samples::read("BMP", decoder, bytes.len())?.integers(colours)
}

pub(super) fn tga(bytes: &[u8], colours: Colours) -> Result<Picture, Fault> {
    let decoder = TgaDecoder::new(Cursor::new(bytes));
    let decoder = decoder.map_err(|error| unreadable("TGA", &error))?;
    Samples::read("TGA", decoder, bytes.len())?.integers(colours)
}

pub(super) fn hdr(bytes: &[u8]) -> Result<Picture, Fault> {
    // Strictly, files that begin with `#?RGBE` would be none.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes));
    let decoder = decoder.map_err(|error| unreadable("HDR", &error))?;
    Samples::read("HDR", decoder, bytes.len())?.floats()
}

/// What a decoder gives: samples in the machine's order of bytes.
struct Samples {
    width: u32,
    height: u32,
    /// 1 and 2 are grey, 2 and 4 have alpha at their end.
    channels: usize,
    bytes_per_sample: usize,
    bytes: Vec<u8>,
}

impl Samples {
    fn read(name: &str, decoder: impl ImageDecoder, file_bytes: usize) -> Result<Self, Fault> {
        let (width, height) = decoder.dimensions();
        let layout = decoder.color_type();
        let bytes_per_texel = usize::from(layout.bytes_per_pixel());
        let channels = usize::from(layout.channel_count());
        let length = texels(width.into(), height.into(), file_bytes)? * bytes_per_texel;
        let mut bytes = room::filled(0, length)?;
        if name == "JPEG" {
            // A progressive one is held whole, as 16-bit coefficients of three channels at most.
            room::look_for(6 * length as u64)?;
        }
        decoder
            .read_image(&mut bytes)
            .map_err(|error| unreadable(name, &error))?;
        Ok(Self {
            width,
            height,
            channels,
            bytes_per_sample: bytes_per_texel / channels,
            bytes,
        })
    }

    fn integers(self, colours: Colours) -> Result<Picture, Fault> {
        let largest = if self.bytes_per_sample == 1 {
            u8::MAX.into()
        } else {
            u16::MAX
        };
        // There are fewer integers than texels, usually.
        let values: Vec<f32> = (0..=largest)
            .map(|i| f32::from(i) / f32::from(largest))
            .map(|v| match colours {
                Colours::Auto => srgb_to_linear(v),
                Colours::Raw => v,
            })
            .collect();
        if self.bytes_per_sample == 1 {
            self.picture(Encoding::Srgb, |[i]| values[usize::from(i)])
        } else {
            self.picture(Encoding::Srgb, |i| {
                values[usize::from(u16::from_ne_bytes(i))]
            })
        }
    }

    fn floats(self) -> Result<Picture, Fault> {
        self.picture(Encoding::Linear, f32::from_ne_bytes)
    }

    /// The picture, with the `value` of each sample of `N` bytes.
    fn picture<const N: usize>(
        self,
        encoding: Encoding,
        value: impl Fn([u8; N]) -> f32,
    ) -> Result<Picture, Fault> {
        let (samples, _) = self.bytes.as_chunks::<N>();
        let colour = if self.channels < 3 { [0; 3] } else { [0, 1, 2] };
        let mut pixels = room::empty(samples.len() / self.channels)?;
        let texels = samples.chunks_exact(self.channels);
        pixels.extend(texels.map(|texel| colour.map(|c| value(texel[c]))));
        Ok(Picture {
            width: self.width,
            height: self.height,
            pixels,
            encoding,
        })
    }
}

fn unreadable(name: &str, error: &ImageError) -> String {
    let cause = match error {
        ImageError::IoError(cause) if cause.kind() == io::ErrorKind::UnexpectedEof => {
            "it ends too early".into()
        }
        ImageError::Limits(_) => {
            "a row of it, or what is written beside it, is absurdly long".into()
        }
        // The decoder's own words, without those of `image` about the format.
        ImageError::Decoding(outer) => match outer.source() {
            Some(inner) => inner.to_string(),
            None => outer.to_string(),
        },
        other => other.to_string(),
    };
    format!("not a readable {name} picture: {cause}")
}
