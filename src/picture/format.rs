//! Which format a file is in, by its first bytes: names lie.

use std::path::Path;

/// The formats that are read without any library of the system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Exr,
    Png,
    Jpeg,
    Hdr,
    Pfm,
    Bmp,
    Tga,
}

const SIGNATURES: [(&[u8], Format); 8] = [
    (b"BM", Format::Bmp),
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"\x89PNG\r\n\x1a\n", Format::Png),
    (b"\xff\xd8\xff", Format::Jpeg),
    (b"#?RADIANCE", Format::Hdr),
    (b"#?RGBE", Format::Hdr),
    (b"PF\n", Format::Pfm),
    (b"Pf\n", Format::Pfm),
];

const EXTENSIONS: [&str; 9] = [
    "exr", "png", "jpg", "jpeg", "hdr", "rgbe", "pfm", "bmp", "tga",
];
/// Of a TGA file.
const TGA_HEADER: usize = 18;

impl Format {
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let mut matching = SIGNATURES.iter().filter(|(s, _)| bytes.starts_with(s));
        let signed = matching.next().map(|(_, format)| *format);
        signed.or_else(|| is_tga(bytes).then_some(Format::Tga))
    }
}

/// Whether a file begins as TGA does, which has no signature: with whether there are colours to
/// look up, the kind of picture, and then a size and a depth.
fn is_tga(bytes: &[u8]) -> bool {
    let Some(header) = bytes.get(..TGA_HEADER) else {
        return false;
    };
    let has_map = header[1] == 1;
    let is_mapped = matches!(header[2], 1 | 9);
    let has_size = header[12..14] != [0; 2] && header[14..16] != [0; 2];
    header[1] <= 1
        && matches!(header[2], 1..=3 | 9..=11)
        && (has_map || !is_mapped)
        && (has_map || header[3..8] == [0; 5])
        && has_size
        && matches!(header[16], 8 | 15 | 16 | 24 | 32)
}

/// What to say of contents that nothing here reads.
pub(super) fn unknown(file: &Path) -> String {
    let extension = file.extension().map(|e| e.to_string_lossy().to_lowercase());
    let more = if cfg!(feature = "oiio") {
        "and whatever OpenImageIO knows"
    } else {
        "and more in a build with `--features oiio`"
    };
    match extension {
        Some(e) if EXTENSIONS.contains(&e.as_str()) => {
            format!(
                "its contents are not what its name says: neither .{e} nor another known format"
            )
        }
        _ => format!("not a known format: EXR, PNG, JPEG, HDR, PFM, BMP and TGA are, {more}"),
    }
}
