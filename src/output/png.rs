//! PNG: eight bits a channel, for looking at.

use super::atomic;
use super::error::FileError;
use crate::picture::Image;
use std::io::Write;
use std::path::Path;

/// Writes a linear image in the sRGB encoding, clipped at white.
pub fn write_image(path: &Path, image: &Image) -> Result<(), FileError> {
    write_bytes(path, image.width, image.height, &srgb_bytes(image), None)
}

/// A linear image in the sRGB encoding, clipped at white: rows of RGB bytes.
pub fn srgb_bytes(image: &Image) -> Vec<u8> {
    image.pixels.iter().flatten().map(|&v| encode(v)).collect()
}

/// The bytes of a file of rows of RGB bytes.
pub fn file_of(width: usize, height: usize, rgb: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    encode_file(width, height, rgb, None)
}

/// The bytes of a file that plays frames of one size, each rows of RGB bytes, again and again.
pub fn animation(
    width: usize,
    height: usize,
    frames: &[Vec<u8>],
    frames_per_second: u16,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(1, frames_per_second)?;
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(frame)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// Writes rows of RGB bytes, with a comment for those who look into the file.
pub fn write_bytes(
    path: &Path,
    width: usize,
    height: usize,
    rgb: &[u8],
    comment: Option<&str>,
) -> Result<(), FileError> {
    let bytes =
        encode_file(width, height, rgb, comment).map_err(|error| FileError::io(path, error))?;
    atomic::write(path, |file| file.write_all(&bytes))
}

/// The bytes of a file of rows of RGB bytes.
pub fn encode_file(
    width: usize,
    height: usize,
    rgb: &[u8],
    comment: Option<&str>,
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    if let Some(comment) = comment {
        encoder.add_text_chunk("Comment".into(), comment.into())?;
    }
    let mut writer = encoder.write_header()?;
    writer.write_image_data(rgb)?;
    writer.finish()?;
    Ok(bytes)
}

/// Linear light to an sRGB byte.
fn encode(linear: f32) -> u8 {
    // `clamp` keeps a NaN, which the cast below turns into 0.
    let v = linear.clamp(0.0, 1.0);
    let coded = if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    };
    (coded * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_has_its_known_values() {
        let known = [
            (-1.0, 0),
            (0.0, 0),
            (0.5, 188),
            (1.0, 255),
            (9.0, 255),
            (f32::NAN, 0),
        ];
        for (linear, byte) in known {
            assert_eq!(encode(linear), byte);
        }
    }
}
