//! Pictures are read as what they mean, whatever their format; broken ones end in one sentence.

use common::picture_files::*;
use std::path::Path;
use warpath::picture::{Colours, Encoding, Picture, decode, read, srgb_to_linear};

/// Through a file, as users do.
fn through_file(name: &str, bytes: &[u8], colours: Colours) -> Result<Picture, String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).expect("a file");
    read(&path, colours).map_err(|error| error.to_string())
}

fn auto(name: &str, bytes: &[u8]) -> Picture {
    through_file(name, bytes, Colours::Auto).unwrap_or_else(|error| panic!("{error}"))
}

fn raw(name: &str, bytes: &[u8]) -> Picture {
    through_file(name, bytes, Colours::Raw).unwrap_or_else(|error| panic!("{error}"))
}

fn linear_byte(byte: u8) -> f32 {
    srgb_to_linear(f32::from(byte) / 255.0)
}

#[test]
fn png_of_8_bits_is_srgb() {
    let data = [0, 10, 11, 128, 200, 255, 255, 0, 1, 2, 3, 4];
    let bytes = png8([2, 2], &data);
    let picture = auto("a.png", &bytes);
    assert_eq!((picture.width, picture.height), (2, 2));
    assert_eq!(picture.encoding, Encoding::Srgb);
    assert_eq!(picture.pixels.as_flattened(), data.map(linear_byte));
    assert_eq!(picture.pixels[0][0], 0.0);
    assert_eq!(picture.pixels[1][2], 1.0);
    let raw = raw("a.png", &bytes);
    assert_eq!(raw.encoding, Encoding::Srgb);
    assert_eq!(
        raw.pixels.as_flattened(),
        data.map(|b| f32::from(b) / 255.0)
    );
}

#[test]
fn png_of_16_bits_is_srgb_too() {
    let data = [0, 1, 2650, 2651, 32768, 65535];
    let bytes = png16([1, 2], &data);
    let value = |v: u16| f32::from(v) / 65535.0;
    let picture = auto("a.png", &bytes);
    assert_eq!((picture.width, picture.height), (1, 2));
    assert_eq!(
        picture.pixels.as_flattened(),
        data.map(value).map(srgb_to_linear)
    );
    assert_eq!(raw("a.png", &bytes).pixels.as_flattened(), data.map(value));
}

#[test]
fn grey_is_spread_and_alpha_is_dropped() {
    use png::{BitDepth::*, ColorType::*};
    let grey = |v| [linear_byte(v); 3];
    let colour = |rgb: [u8; 3]| rgb.map(linear_byte);
    let cases = [
        (
            "grey",
            png([2, 1], Grayscale, Eight, &[7, 200]),
            [grey(7), grey(200)],
        ),
        (
            "grey, 16",
            png([2, 1], Grayscale, Sixteen, &[7, 7, 200, 200]),
            [grey(7), grey(200)],
        ),
        (
            "bits",
            png([2, 1], Grayscale, One, &[0b0100_0000]),
            [grey(0), grey(255)],
        ),
        (
            "grey with alpha",
            png([2, 1], GrayscaleAlpha, Eight, &[7, 0, 200, 9]),
            [grey(7), grey(200)],
        ),
        // Not multiplied by alpha either, even where nothing is left.
        (
            "alpha",
            png([2, 1], Rgba, Eight, &[1, 20, 30, 0, 4, 50, 60, 128]),
            [colour([1, 20, 30]), colour([4, 50, 60])],
        ),
        (
            "palette",
            png([2, 1], Indexed, Eight, &[1, 0]),
            [colour([255, 102, 0]), colour([0, 51, 255])],
        ),
    ];
    for (what, bytes, expected) in cases {
        assert_eq!(auto("a.png", &bytes).pixels, expected, "{what}");
    }
}

/// JPEG loses a little: two of 255 steps on a picture this smooth.
#[test]
fn jpeg_is_srgb() {
    let ramp = |i: usize| (40 + 5 * (i % 24) + 3 * (i / 24)) as u8;
    let colours: Vec<u8> = (0..24 * 20)
        .flat_map(|i| [ramp(i), 200 - ramp(i) / 2, 128])
        .collect();
    let greys: Vec<u8> = (0..24 * 20).map(ramp).collect();
    let spread: Vec<u8> = greys.iter().flat_map(|v| [*v; 3]).collect();
    for (stored, file) in [
        (
            &colours,
            jpeg([24, 20], &colours, image::ExtendedColorType::Rgb8),
        ),
        (
            &spread,
            jpeg([24, 20], &greys, image::ExtendedColorType::L8),
        ),
    ] {
        let picture = raw("a.jpg", &file);
        assert_eq!((picture.width, picture.height), (24, 20));
        assert_eq!(picture.encoding, Encoding::Srgb);
        for (found, stored) in picture.pixels.as_flattened().iter().zip(stored) {
            let steps = found * 255.0 - f32::from(*stored);
            assert!(steps.abs() <= 2.0, "{steps} steps off");
        }
        let linear = picture
            .pixels
            .as_flattened()
            .iter()
            .map(|v| srgb_to_linear(*v));
        let linear: Vec<f32> = linear.collect();
        assert_eq!(auto("a.jpeg", &file).pixels.as_flattened(), linear);
    }
}

#[test]
fn hdr_is_linear() {
    // Exact in eight bits with a common exponent.
    let pixels = [
        [1.0, 0.5, 0.25],
        [1000.0, 8.0, 16.0],
        [0.0; 3],
        [3e-5, 0.0, 0.0],
    ];
    let bytes = hdr([2, 2], &pixels);
    for colours in [Colours::Auto, Colours::Raw] {
        let picture = through_file("a.hdr", &bytes, colours).expect("a picture");
        assert_eq!((picture.width, picture.height), (2, 2));
        assert_eq!(picture.encoding, Encoding::Linear);
        for (found, wanted) in picture
            .pixels
            .as_flattened()
            .iter()
            .zip(pixels.as_flattened())
        {
            assert!(
                (found - wanted).abs() <= wanted / 128.0,
                "{found} for {wanted}"
            );
        }
        assert_eq!(picture.pixels[..2], pixels[..2]);
    }
    let other_name = [b"#?RGBE".as_slice(), &bytes[b"#?RADIANCE".len()..]].concat();
    assert_eq!(auto("a.hdr", &other_name), auto("a.hdr", &bytes));
}

const WIDE: [[f32; 3]; 6] = [
    [0.0, 1.0, 2.0],
    [-0.5, 0.25, 1e-3],
    [6.0e4, 3.0, 7.0],
    [0.1, 0.2, 0.3],
    [1e-7, 5.0, 0.0],
    [9.0, 8.0, 7.0],
];

#[test]
fn exr_is_linear() {
    let rounded = WIDE.map(|p| p.map(|v| exr::prelude::f16::from_f32(v).to_f32()));
    for colours in [Colours::Auto, Colours::Raw] {
        let floats = through_file("a.exr", &exr_rgb([3, 2], &WIDE, float), colours);
        let floats = floats.expect("a picture");
        assert_eq!((floats.width, floats.height), (3, 2));
        assert_eq!(floats.encoding, Encoding::Linear);
        assert_eq!(floats.pixels, WIDE);
        let halves = through_file("a.exr", &exr_rgb([3, 2], &WIDE, half), colours);
        assert_eq!(halves.expect("a picture").pixels, rounded);
    }
}

/// Every way of cutting and compressing without loss; with a size that tiles do not divide.
#[test]
fn exr_is_read_however_it_is_coded() {
    use exr::prelude::{Blocks, Compression, Encoding, LineOrder, Vec2};
    let size = [37, 53];
    let pixels: Vec<[f32; 3]> = (0..size[0] * size[1])
        .map(|i| [i as f32, 0.5 * (i % 7) as f32, -(i as f32)])
        .collect();
    let [r, g, b] = planes(&pixels);
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ] {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 8))] {
            for line_order in [LineOrder::Increasing, LineOrder::Decreasing] {
                let encoding = Encoding {
                    compression,
                    blocks,
                    line_order,
                };
                let channels = vec![float("R", &r), float("G", &g), float("B", &b)];
                let bytes = exr_coded(size, encoding, channels);
                let found = auto("a.exr", &bytes).pixels;
                assert!(found == pixels, "{compression:?} {blocks:?} {line_order:?}");
            }
        }
    }
}

/// The data window is the picture, wherever it is in the window that is shown.
#[test]
fn exr_windows_are_left_out_of_it() {
    use exr::prelude::{AnyChannels, Encoding, Layer, LayerAttributes, Vec2};
    let [r, g, b] = planes(&WIDE);
    let channels = [float("R", &r), float("G", &g), float("B", &b)];
    for position in [Vec2(-3, 5), Vec2(1000, -2000)] {
        let layer = Layer::new(
            (3, 2),
            LayerAttributes::named("moved").with_position(position),
            Encoding::SMALL_LOSSLESS,
            AnyChannels::sort(channels.iter().cloned().collect()),
        );
        assert_eq!(
            auto("a.exr", &exr_layer(layer)).pixels,
            WIDE,
            "{position:?}"
        );
    }
}

#[test]
fn exr_channels_are_found_by_name() {
    let one = |name: &str, v: f32| float(name, &[v, v + 0.5]);
    let rgb = [[1.0, 2.0, 3.0], [1.5, 2.5, 3.5]];
    let colours = || vec![one("R", 1.0), half("G", &[2.0, 2.5]), one("B", 3.0)];
    let with = |more: Vec<_>| exr([2, 1], [colours(), more].concat());
    let nan = [f32::NAN; 2];
    for (what, bytes, expected) in [
        ("of two types", with(vec![]), rgb),
        ("alpha", with(vec![one("A", 0.0)]), rgb),
        (
            "others",
            with(vec![float("Z", &nan), one("diffuse.R", 9.0)]),
            rgb,
        ),
        (
            "grey",
            exr([2, 1], vec![one("Y", 4.0)]),
            [[4.0; 3], [4.5; 3]],
        ),
        (
            "grey and alpha",
            exr([2, 1], vec![half("Y", &[4.0, 5.0]), one("A", 0.0)]),
            [[4.0; 3], [5.0; 3]],
        ),
    ] {
        assert_eq!(auto("a.exr", &bytes).pixels, expected, "{what}");
    }
}

#[test]
fn pfm_is_linear_and_begins_at_the_bottom() {
    let top_down = [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]];
    let bottom_up = [4.0f32, 5.0, 6.0, 1.0, 2.0, 3.0];
    let little = pfm("PF\n1 2\n-1.0\n", bottom_up.map(f32::to_le_bytes));
    assert_eq!(auto("a.pfm", &little).pixels, top_down);
    let big = pfm("PF\n1 2\n2\n", bottom_up.map(|v| (0.5 * v).to_be_bytes()));
    assert_eq!(auto("a.pfm", &big).pixels, top_down);
    let grey = pfm("Pf\n2 1\n-1\n", [7.0f32, 8.0].map(f32::to_le_bytes));
    assert_eq!(auto("a.pfm", &grey).pixels, [[7.0; 3], [8.0; 3]]);
}

#[test]
fn contents_decide_and_not_the_name() {
    let bytes = png8([1, 1], &[255, 255, 255]);
    for name in ["a.png", "a.exr", "a.jpg", "a.tif", "a", "a.PNG", ".png"] {
        assert_eq!(auto(name, &bytes).pixels, [[1.0; 3]], "{name}");
    }
}

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

#[test]
fn broken_files_end_in_one_sentence() {
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
    #[rustfmt::skip]
    let cases: Vec<(&str, Vec<u8>, &str)> = vec![
        ("empty.png", vec![], "the file is empty"),
        ("notes.txt", text("# a list\n"), "not a known format: EXR, PNG, JPEG, HDR and PFM are"),
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
    let mut wrong = Vec::new();
    for (name, bytes, expected) in cases {
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
