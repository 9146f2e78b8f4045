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
}

const SIGNATURES: [(&[u8], Format); 7] = [
    (b"\x76\x2f\x31\x01", Format::Exr),
    (b"\x89PNG\r\n\x1a\n", Format::Png),
    (b"\xff\xd8\xff", Format::Jpeg),
    (b"#?RADIANCE", Format::Hdr),
    (b"#?RGBE", Format::Hdr),
    (b"PF\n", Format::Pfm),
    (b"Pf\n", Format::Pfm),
];

const EXTENSIONS: [&str; 7] = ["exr", "png", "jpg", "jpeg", "hdr", "rgbe", "pfm"];

impl Format {
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let mut matching = SIGNATURES.iter().filter(|(s, _)| bytes.starts_with(s));
        matching.next().map(|(_, format)| *format)
    }
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
        _ => format!("not a known format: EXR, PNG, JPEG, HDR and PFM are, {more}"),
    }
}
