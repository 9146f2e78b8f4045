//! OpenImageIO reads what the built-in readers read to the same values, and the formats they do not
//! know.
//!
//! Files that nothing else here writes are made by `oiiotool` and `maketx` (Debian:
//! openimageio-tools).

use common::picture_files::*;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use warpath::picture::{Colours, Encoding, Picture, oiio, read};

/// A folder with the same picture as 8-bit and 16-bit integers and as floats, 40 × 24.
struct Files {
    folder: tempfile::TempDir,
}

const SIZE: [u32; 2] = [40, 24];

impl Files {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let [width, height] = SIZE;
        let count = (width * height) as usize;
        let bytes: Vec<u8> = (0..3 * count).map(|i| (i * 7 % 256) as u8).collect();
        let words: Vec<u16> = (0..3 * count).map(|i| (i * 977 % 65536) as u16).collect();
        let pixels: Vec<[f32; 3]> = (0..count)
            .map(|i| {
                [
                    i as f32 / 64.0,
                    (i % 13) as f32,
                    0.1 + 1e-3 * (i % 29) as f32,
                ]
            })
            .collect();
        let size = SIZE.map(|n| n as usize);
        let files = Self { folder };
        for (name, contents) in [
            ("bytes.png", png8(SIZE, &bytes)),
            ("words.png", png16(SIZE, &words)),
            ("half.exr", exr_rgb(size, &pixels, half)),
            ("float.exr", exr_rgb(size, &pixels, float)),
            ("light.hdr", hdr(size, &pixels)),
        ] {
            std::fs::write(files.path(name), contents).expect("a file");
        }
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Makes the file `name` by a program of openimageio-tools; `arguments` may name files of this
    /// folder.
    fn make(&self, program: &str, arguments: &[&str], name: &str) -> PathBuf {
        let _ = std::fs::remove_file(self.path(name));
        let output = Command::new(program)
            .args(arguments.iter().map(OsStr::new))
            .current_dir(self.folder.path())
            .output()
            .unwrap_or_else(|error| {
                panic!("{program}: {error}: these tests need it: sudo apt-get install openimageio-tools")
            });
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(
            output.status.success() && self.path(name).exists(),
            "{program} {arguments:?}: {said}"
        );
        self.path(name)
    }
}

fn get(result: Result<Picture, warpath::picture::PictureError>) -> Picture {
    result.unwrap_or_else(|error| panic!("{error}"))
}

/// The same to a few roundings: OpenImageIO multiplies by 1/255 where division is meant.
fn assert_same(what: &str, found: &Picture, wanted: &Picture) {
    assert_eq!(
        (found.width, found.height),
        (wanted.width, wanted.height),
        "{what}"
    );
    assert_eq!(found.encoding, wanted.encoding, "{what}");
    for (i, (f, w)) in found
        .pixels
        .as_flattened()
        .iter()
        .zip(wanted.pixels.as_flattened())
        .enumerate()
    {
        assert!(
            (f - w).abs() <= 1e-6 * w.abs(),
            "{what}: number {i} is {f} and not {w}"
        );
    }
}

#[test]
fn built_in_formats_are_read_to_the_same_values() {
    let files = Files::new();
    for name in [
        "bytes.png",
        "words.png",
        "half.exr",
        "float.exr",
        "light.hdr",
    ] {
        for colours in [Colours::Auto, Colours::Raw] {
            let path = files.path(name);
            assert_same(
                name,
                &get(oiio::read(&path, colours)),
                &get(read(&path, colours)),
            );
        }
    }
}

#[test]
fn tiff_is_read_as_what_it_was_made_of() {
    let files = Files::new();
    for (from, name, kind) in [
        ("bytes.png", "bytes.tif", "uint8"),
        ("words.png", "words.tif", "uint16"),
        ("float.exr", "float.tif", "float"),
        ("half.exr", "half.tif", "half"),
    ] {
        let path = files.make("oiiotool", &[from, "-d", kind, "-o", name], name);
        for colours in [Colours::Auto, Colours::Raw] {
            let wanted = get(read(&files.path(from), colours));
            assert_same(name, &get(read(&path, colours)), &wanted);
        }
    }
}

/// Tiles, and levels below the largest one.
#[test]
fn textures_are_read_at_full_size() {
    let files = Files::new();
    for (from, name) in [
        ("bytes.png", "bytes.tx"),
        ("words.png", "words.tx"),
        ("float.exr", "float.tx"),
    ] {
        // By itself it would grow the texture to powers of two.
        let options = ["--noresize", "--tile", "16", "16", from, "-o", name];
        let path = files.make("maketx", &options, name);
        assert_is_mip_mapped(&path);
        for colours in [Colours::Auto, Colours::Raw] {
            let wanted = get(read(&files.path(from), colours));
            assert_same(name, &get(read(&path, colours)), &wanted);
        }
    }
}

/// This one is the built-in reader's: an EXR, whatever it is called.
#[test]
fn textures_in_exr_are_read_at_full_size() {
    let files = Files::new();
    let options = [
        "--noresize",
        "--tile",
        "16",
        "16",
        "--format",
        "exr",
        "float.exr",
        "-o",
        "a.tx",
    ];
    let path = files.make("maketx", &options, "a.tx");
    assert_is_mip_mapped(&path);
    let wanted = get(read(&files.path("float.exr"), Colours::Auto));
    assert_same("a.tx", &get(read(&path, Colours::Auto)), &wanted);
}

fn assert_is_mip_mapped(path: &Path) {
    let output = Command::new("oiiotool")
        .args(["--info", "-v"])
        .arg(path)
        .output();
    let output = output.expect("oiiotool: sudo apt-get install openimageio-tools");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(
        said.contains("MIP-map levels") && said.contains("tile size: 16 x 16"),
        "{said}"
    );
}

#[test]
fn integers_that_are_said_to_be_linear_stay_as_they_are() {
    let files = Files::new();
    let wanted = get(read(&files.path("words.png"), Colours::Raw));
    // TIFF has no place for the name of a colour space; DPX has.
    let options = [
        "words.png",
        "--iscolorspace",
        "linear",
        "-d",
        "uint16",
        "-o",
        "linear.dpx",
    ];
    let path = files.make("oiiotool", &options, "linear.dpx");
    let found = get(read(&path, Colours::Auto));
    assert_eq!(found.encoding, Encoding::Linear);
    let wanted = Picture {
        encoding: Encoding::Linear,
        ..wanted
    };
    assert_same("linear.dpx", &found, &wanted);
}

#[test]
fn grey_is_spread_and_alpha_is_dropped() {
    let files = Files::new();
    let alpha = png(
        [2, 1],
        png::ColorType::Rgba,
        png::BitDepth::Eight,
        &[10, 20, 30, 0, 40, 50, 60, 128],
    );
    std::fs::write(files.path("alpha.png"), alpha).expect("a file");
    let grey = png(
        [2, 1],
        png::ColorType::GrayscaleAlpha,
        png::BitDepth::Eight,
        &[10, 0, 40, 128],
    );
    std::fs::write(files.path("grey.png"), grey).expect("a file");
    for name in ["alpha.png", "grey.png"] {
        let path = files.path(name);
        assert_same(
            name,
            &get(oiio::read(&path, Colours::Auto)),
            &get(read(&path, Colours::Auto)),
        );
    }
}

#[test]
fn broken_files_end_in_one_sentence() {
    let files = Files::new();
    let whole = files.make("oiiotool", &["float.exr", "-o", "whole.tif"], "whole.tif");
    let whole = std::fs::read(whole).expect("a file");
    let options = ["float.exr", "--compression", "none", "-o", "plain.tif"];
    let plain = files.make("oiiotool", &options, "plain.tif");
    let plain = std::fs::read(plain).expect("a file");
    let nan = exr_rgb([1, 1], &[[1.0, f32::NAN, 1.0]], float);
    std::fs::write(files.path("nan.exr"), nan).expect("a file");
    let channels = exr(
        [1, 1],
        ["X", "Z", "W"].map(|name| float(name, &[1.0])).to_vec(),
    );
    std::fs::write(files.path("xzw.exr"), channels).expect("a file");
    files.make("oiiotool", &["nan.exr", "-o", "nan.tif"], "nan.tif");
    for (name, bytes) in [
        ("empty.tif", &whole[..0]),
        ("header.tif", &whole[..10]),
        ("short.tif", &whole[..whole.len() / 2]),
        ("plain.tif", &plain[..plain.len() - 100]),
        ("notes.tif", b"nothing at all".as_slice()),
        ("notes", b"nothing at all"),
        ("photo.png", b"nothing at all"),
    ] {
        std::fs::write(files.path(name), bytes).expect("a file");
    }
    let mut wrong = Vec::new();
    for (name, expected) in [
        ("empty.tif", "the file is empty"),
        ("header.tif", "OpenImageIO says: "),
        ("short.tif", "not a readable picture: OpenImageIO says: "),
        ("plain.tif", "not a readable picture: OpenImageIO says: "),
        ("notes.tif", "not a known format"),
        ("notes", "not a known format"),
        ("photo.png", "its contents are not what its name says"),
        ("nan.tif", "the texel at x 0, y 0 is not finite"),
    ] {
        match read(&files.path(name), Colours::Auto) {
            Ok(_) => wrong.push(format!("{name} is read")),
            Err(error) => {
                let said = error.to_string();
                if !said.contains(&format!("/{name}: "))
                    || !said.contains(expected)
                    || said.contains('\n')
                {
                    wrong.push(format!(
                        "{name}: expected \"{expected}\" and not \"{said}\""
                    ));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let error = oiio::read(&files.path("xzw.exr"), Colours::Auto).expect_err("no colours");
    assert!(
        error
            .to_string()
            .contains("neither R, G and B, nor Y, but "),
        "{error}"
    );
}
