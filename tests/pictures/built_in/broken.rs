//! Files that are damaged, absurd, or none.

use super::{WIDE, through_file};
use common::picture_files::*;
use std::path::Path;
use warpath::picture::{Colours, decode, read};

/// PNG's checksum, so that only what is meant is wrong with a file.
fn chunk(kind: &[u8], data: &[u8]) -> Vec<u8> {
    let mut crc = !0u32;
    for byte in kind.iter().chain(data) {
        crc ^= u32::from(*byte);
        for _ in 0..8 {
            crc = (crc >> 1) ^ (0xedb8_8320 & (crc & 1).wrapping_neg());
        }
    }
    let length = (data.len() as u32).to_be_bytes();
    [&length, kind, data, &(!crc).to_be_bytes()].concat()
}

fn png_claiming(width: u32, height: u32) -> Vec<u8> {
    let size = [width.to_be_bytes(), height.to_be_bytes()].concat();
    let header = chunk(b"IHDR", &[&size[..], &[8, 2, 0, 0, 0]].concat());
    let data = chunk(b"IDAT", &[0x78, 0x9c, 3, 0, 0, 0, 0, 1]);
    [
        b"\x89PNG\r\n\x1a\n",
        &header[..],
        &data,
        &chunk(b"IEND", &[]),
    ]
    .concat()
}

/// An EXR whose data window claims more than is there.
fn exr_claiming(width: i32, height: i32) -> Vec<u8> {
    let mut bytes = exr_rgb([3, 2], &WIDE, float);
    let find = |bytes: &[u8], name: &[u8]| bytes.windows(name.len()).position(|w| w == name);
    // With another name, the number of blocks no longer contradicts the window.
    let at = find(&bytes, b"chunkCount\0").expect("a count");
    bytes[at] = b'C';
    let name = b"dataWindow\0box2i\0\x10\0\0\0";
    let at = find(&bytes, name).expect("a window") + name.len();
    bytes[at..at + 16].copy_from_slice(
        [0, 0, width - 1, height - 1]
            .map(i32::to_le_bytes)
            .as_flattened(),
    );
    bytes
}

fn resized(mut bytes: Vec<u8>, keep: usize) -> Vec<u8> {
    bytes.truncate(keep);
    bytes
}

/// Names, contents, and what is said of them.
fn broken_files() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let wide = |n: usize| vec![0.5f32; n];
    let integers = || {
        use exr::prelude::{AnyChannel, FlatSamples};
        ["R", "G", "B"]
            .map(|name| AnyChannel::new(name, FlatSamples::U32(vec![1, 2])))
            .to_vec()
    };
    let infinite = [[1.0, 2.0, 3.0], [4.0, f32::INFINITY, 6.0]];
    let nan = [
        [1.0; 3],
        [1.0; 3],
        [1.0; 3],
        [1.0; 3],
        [1.0, 1.0, f32::NAN],
        [1.0; 3],
    ];
    let photo = jpeg([16, 16], &[90; 768], image::ExtendedColorType::Rgb8);
    let bright = hdr([2, 1], &[[1.0; 3], [2.0; 3]]);
    let whole = png8([4, 4], &[100; 48]);
    let floats = exr_rgb([3, 2], &WIDE, float);
    let le = |v: [f32; 3]| v.map(f32::to_le_bytes);
    let text = |s: &str| s.as_bytes().to_vec();
    // One line a file, however long.
    #[rustfmt::skip]
    let cases = vec![
        ("empty.png", vec![], "the file is empty"),
        ("notes.txt", text("# a list\n"), "not a known format: EXR, PNG, JPEG, HDR, PFM, BMP and TGA are"),
        ("none", text("x"), "not a known format"),
        ("photo.JPG", text("<html>not found</html>"), "its contents are not what its name says: neither .jpg nor another known format"),
        ("sky.exr", text("PK\x03\x04"), "its contents are not what its name says: neither .exr"),
        ("short.png", resized(whole.clone(), 50), "not a readable PNG picture: it ends too early"),
        ("header.png", resized(whole.clone(), 20), "not a readable PNG picture: it ends too early"),
        ("crc.png", { let mut b = whole; b[17] ^= 1; b }, "not a readable PNG picture: CRC error"),
        ("huge.png", png_claiming(1 << 30, 1 << 30), "not a readable PNG picture: a row of it, or what is written beside it, is absurdly long"),
        ("wide.png", png_claiming(1 << 22, 1 << 22), "its size of 4194304 × 4194304 is absurd: 268435456 texels are the most"),
        ("large.png", png_claiming(16384, 16384), "it ends too early: 65 bytes for 16384 × 16384 texels"),
        ("zero.png", png_claiming(0, 5), "not a readable PNG picture"),
        ("less.png", png_claiming(300, 300), "not a readable PNG picture"),
        ("short.jpg", resized(photo.clone(), photo.len() - 2), "not a readable JPEG picture: it ends too early"),
        ("start.jpg", resized(photo.clone(), 40), "not a readable JPEG picture: it ends too early"),
        ("three.jpg", resized(photo, 3), "not a readable JPEG picture: it ends too early"),
        ("bare.jpg", vec![0xff, 0xd8, 0xff, 0xd9], "not a readable JPEG picture"),
        ("short.hdr", resized(bright.clone(), bright.len() - 1), "not a readable HDR picture: it ends too early"),
        ("name.hdr", text("#?RADIANCE"), "not a readable HDR picture"),
        ("huge.hdr", text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 4000000000 +X 4000000000\n"), "not a readable HDR picture: "),
        ("large.hdr", text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 30000 +X 30000\n"), "its size of 30000 × 30000 is absurd"),
        ("zero.hdr", text("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 0 +X 4\n"), "it has no texels: its size is 4 × 0"),
        ("xyz.hdr", text("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x01\x01\x01\x01"), "not a readable HDR picture: The image format `32-bit_rle_xyze` is not supported"),
        ("short.exr", resized(floats.clone(), floats.len() - 3), "not a readable OpenEXR picture: it ends too early"),
        ("header.exr", resized(floats, 100), "not a readable OpenEXR picture: it ends too early"),
        ("huge.exr", exr_claiming(1 << 29, 1 << 29), "its size of 536870912 × 536870912 is absurd"),
        ("large.exr", exr_claiming(30000, 30000), "its size of 30000 × 30000 is absurd"),
        ("big.exr", exr_claiming(16384, 16000), "it ends too early"),
        ("infinite.exr", exr_rgb([2, 1], &infinite, float), "the texel at x 1, y 0 is not finite"),
        ("nan.exr", exr_rgb([3, 2], &nan, half), "the texel at x 1, y 1 is not finite"),
        ("normals.exr", exr([2, 1], vec![float("X", &wide(2)), float("Z", &wide(2))]), "it has no channels R, G and B, nor Y without chroma, but X, Z"),
        ("chroma.exr", exr([2, 1], vec![float("Y", &wide(2)), float("RY", &wide(2)), float("BY", &wide(2))]), "nor Y without chroma, but BY, RY, Y"),
        ("layers.exr", exr([2, 1], vec![float("a.R", &wide(2)), float("a.G", &wide(2)), float("a.B", &wide(2))]), "but a.B, a.G, a.R"),
        ("ids.exr", exr([2, 1], integers()), "its channels are 32-bit integers: save them as half or float"),
        ("short.pfm", pfm("PF\n2 1\n-1\n", le([1.0; 3])), "not a readable PFM picture: it ends too early"),
        ("huge.pfm", pfm("PF\n99999 99999\n-1\n", le([1.0; 3])), "its size of 99999 × 99999 is absurd"),
        ("size.pfm", pfm("PF\n2 -1\n-1\n", le([1.0; 3])), "not a readable PFM picture: its height is \"-1\""),
        ("scale.pfm", pfm("PF\n1 1\n0\n", le([1.0; 3])), "not a readable PFM picture: its scale is 0"),
        ("header.pfm", text("PF\n1 1"), "not a readable PFM picture: its header is no text"),
        ("nan.pfm", pfm("PF\n1 1\n-1\n", le([1.0, f32::NAN, 1.0])), "the texel at x 0, y 0 is not finite"),
    ];
    cases
}

#[test]
fn broken_files_end_in_one_sentence() {
    let mut wrong = Vec::new();
    for (name, bytes, expected) in broken_files() {
        match through_file(name, &bytes, Colours::Auto) {
            Ok(_) => wrong.push(format!("{name} is read")),
            Err(said) => {
                let names_it = said.contains(&format!("/{name}: "));
                if !names_it || !said.contains(expected) || said.contains('\n') || said.len() > 300
                {
                    wrong.push(format!(
                        "{name}: expected \"{expected}\" and not \"{said}\""
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn what_is_no_file_is_said_to_be_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("file");
    std::fs::write(&file, "x").expect("a file");
    for (path, expected) in [
        (folder.path().join("none.png"), "none.png: no such file"),
        (file.join("below.png"), "below.png: no such file"),
        (folder.path().to_path_buf(), ": not a regular file"),
        ("/dev/zero".into(), "/dev/zero: not a regular file"),
    ] {
        let error = read(&path, Colours::Auto).expect_err("no picture");
        assert!(error.to_string().ends_with(expected), "{error}");
        assert!(!error.is_io(), "{error}: the input is bad, not the machine");
    }
}

/// Nothing that is cut off is read, and no byte that is wrong makes anything panic.
#[test]
fn damaged_files_are_refused_or_read_but_never_panic() {
    let data: Vec<u8> = (0..75).map(|i| i * 3).collect();
    let [r, g, b] = planes(&WIDE);
    let tiles = exr::prelude::Encoding {
        blocks: exr::prelude::Blocks::Tiles(exr::prelude::Vec2(2, 2)),
        ..exr::prelude::Encoding::FAST_LOSSLESS
    };
    let tiles = exr_coded(
        [3, 2],
        tiles,
        vec![half("R", &r), half("G", &g), half("B", &b)],
    );
    let files = [
        // A PNG's end marker comes after all texels: 12 bytes, and 4 of the checksum before it.
        ("PNG", png8([5, 5], &data), 16),
        (
            "JPEG",
            jpeg([5, 5], &data, image::ExtendedColorType::Rgb8),
            0,
        ),
        ("HDR", hdr([3, 2], &WIDE.map(|p| p.map(f32::abs))), 0),
        ("EXR", exr_rgb([3, 2], &WIDE, half), 0),
        ("tiled EXR", tiles, 0),
        (
            "PFM",
            pfm(
                "PF\n2 3\n-1.0\n",
                WIDE.as_flattened().iter().map(|v| v.to_le_bytes()),
            ),
            0,
        ),
    ];
    let name = Path::new("damaged");
    for (what, mut bytes, end) in files {
        decode(&bytes, name, Colours::Auto).unwrap_or_else(|error| panic!("{what}: {error}"));
        for length in 0..bytes.len() - end {
            let cut = decode(&bytes[..length], name, Colours::Auto);
            assert!(cut.is_err(), "{what} of {length} bytes in {}", bytes.len());
        }
        for at in 0..bytes.len() {
            let whole = bytes[at];
            for wrong in [0, 1, 0x7f, 0x80, 0xff, whole ^ 1, whole ^ 0x10] {
                bytes[at] = wrong;
                if let Ok(picture) = decode(&bytes, name, Colours::Raw) {
                    assert_eq!(
                        picture.pixels.len() as u64,
                        u64::from(picture.width) * u64::from(picture.height)
                    );
                }
            }
            bytes[at] = whole;
        }
    }
}
