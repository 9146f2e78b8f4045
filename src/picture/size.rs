//! Sizes, checked before memory is asked for: a broken header may claim anything.

/// 16384 × 16384: 3 GiB as floats.
const MOST_TEXELS: u64 = 1 << 28;

/// The best compressed of pictures, one colour in a wavelet-compressed EXR, holds fewer texels a
/// byte.
const MOST_TEXELS_A_BYTE: u64 = 1 << 16;

/// The number of texels of a picture in a file of `file_bytes`.
pub(super) fn texels(width: u64, height: u64, file_bytes: usize) -> Result<usize, String> {
    let count = width.saturating_mul(height);
    if count == 0 {
        return Err(format!("it has no texels: its size is {width} × {height}"));
    }
    if count > MOST_TEXELS || width.max(height) > u64::from(u32::MAX) {
        return Err(format!(
            "its size of {width} × {height} is absurd: {MOST_TEXELS} texels are the most"
        ));
    }
    if count / MOST_TEXELS_A_BYTE > file_bytes as u64 {
        return Err(format!(
            "it ends too early: {file_bytes} bytes for {width} × {height} texels"
        ));
    }
    Ok(count as usize)
}
