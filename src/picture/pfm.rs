//! Portable float maps: a line each for the kind, the size and the scale, then plain floats.

use super::error::Fault;
use super::size::texels;
use super::{Encoding, Picture};
use crate::room;

/// The kind, width and height at the beginning of `rest`, which then is what follows them.
pub(super) fn header<'a>(rest: &mut &'a [u8]) -> Result<(&'a str, [u32; 2]), String> {
    let kind = word(rest)?;
    Ok((kind, [number(rest, "width")?, number(rest, "height")?]))
}

pub(super) fn decode(bytes: &[u8]) -> Result<Picture, Fault> {
    let mut rest = bytes;
    let (kind, [width, height]) = header(&mut rest)?;
    let channels = if kind == "PF" { 3 } else { 1 };
    let scale: f32 = number(&mut rest, "scale")?;
    if !scale.is_finite() || scale == 0.0 {
        return Err(format!("not a readable PFM picture: its scale is {scale}").into());
    }
    let count = texels(width.into(), height.into(), bytes.len())?;
    let Some(data) = rest.get(..count * channels * 4) else {
        return Err("not a readable PFM picture: it ends too early".into());
    };
    // The sign of the scale tells the order of bytes.
    let value = |bytes: [u8; 4]| {
        scale.abs()
            * if scale < 0.0 {
                f32::from_le_bytes(bytes)
            } else {
                f32::from_be_bytes(bytes)
            }
    };
    let (floats, _) = data.as_chunks::<4>();
    let mut pixels = room::empty(count)?;
    // Rows come from the bottom.
    for row in floats.chunks_exact(width as usize * channels).rev() {
        pixels.extend(row.chunks_exact(channels).map(|texel| match *texel {
            [r, g, b] => [r, g, b].map(value),
            _ => [value(texel[0]); 3],
        }));
    }
    Ok(Picture {
        width,
        height,
        pixels,
        encoding: Encoding::Linear,
    })
}

/// The next word, and the one white byte after it.
fn word<'a>(rest: &mut &'a [u8]) -> Result<&'a str, String> {
    let end = rest.iter().position(u8::is_ascii_whitespace);
    let word = end.and_then(|end| {
        let word = std::str::from_utf8(&rest[..end]).ok();
        *rest = &rest[end + 1..];
        word
    });
    word.ok_or_else(|| "not a readable PFM picture: its header is no text".into())
}

fn number<T: std::str::FromStr>(rest: &mut &[u8], what: &str) -> Result<T, String> {
    let word = word(rest)?;
    word.parse()
        .map_err(|_| format!("not a readable PFM picture: its {what} is \"{word}\""))
}
