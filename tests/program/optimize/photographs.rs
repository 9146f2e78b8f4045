//! Pictures with cameras that other programs have found.

use super::optimize;
use crate::workplace::{text, warpath, workplace};
use std::path::Path;

/// The workplace's camera at 40×30 pixels, as NeRF's programs have it: along −z, +x right, +y up.
const NERF: &str = r#"{"camera_angle_x": 0.6981317007977318, "w": 40, "h": 30, "frames": [
  {"file_path": "photo/image", "mask_path": "MASK", "transform_matrix":
    [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 4], [0, 0, 0, 1]]}]}"#;
/// The same as COLMAP has it, from the world: along +z, +x right, +y down.
const COLMAP: [&str; 2] = [
    "1 PINHOLE 40 30 54.94954839 54.94954839 20 15\n",
    "1 0 1 0 0 0 0 4 1 image.png\n\n",
];
const CONFIG: &str = r#"scene = "s.xml"
steps = 60

[truth]
targets = "pictures"

[cameras]
CAMERAS

[render]
spp = 16

[optimizer]
lr = { start = 0.03, end = 0.001 }

[output]
spp = 4

[parameters."card.translation"]
start = [0.12, -0.08, 0]
"#;
const BY_NERF: &str = "transforms = \"t.json\"";
const BY_COLMAP: &str = "colmap = \".\"\nimages = \"photo\"\nmasks = \"masks\"";

/// The workplace with a picture of its scene, white masks and cameras of both kinds.
fn studio() -> tempfile::TempDir {
    let directory = workplace();
    let at = directory.path();
    let line = [
        "render",
        "s.xml",
        "-o",
        "photo",
        "--resolution",
        "40x30",
        "--spp",
        "1024",
        "-q",
    ];
    let out = warpath(at, &line);
    assert!(out.status.success(), "{}", text(&out.stderr));
    mask(at, [255, 255]);
    std::fs::write(at.join("t.json"), NERF.replace("MASK", "masks/image.png")).unwrap();
    std::fs::write(at.join("cameras.txt"), COLMAP[0]).unwrap();
    std::fs::write(at.join("images.txt"), COLMAP[1]).unwrap();
    directory
}

/// A mask whose left and right halves have these values.
fn mask(at: &Path, halves: [u8; 2]) {
    let row: Vec<u8> = (0..40).map(|x| halves[x / 20]).collect();
    std::fs::create_dir_all(at.join("masks")).unwrap();
    let file = at.join("masks/image.png");
    image::GrayImage::from_raw(40, 30, row.repeat(30))
        .unwrap()
        .save(file)
        .unwrap();
}

fn run(at: &Path, cameras: &str, arguments: &[&str]) -> (Option<i32>, String) {
    std::fs::write(at.join("c.toml"), CONFIG.replace("CAMERAS", cameras)).unwrap();
    let mut all = vec!["-o", "out", "--fresh"];
    all.extend(arguments);
    optimize(at, "c.toml", &all)
}

fn report(at: &Path) -> serde_json::Value {
    let bytes = std::fs::read(at.join("out/report.json")).unwrap();
    serde_json::from_slice(&bytes).unwrap()
}

#[test]
fn a_position_from_a_photograph_by_both_kinds_of_cameras() {
    let directory = studio();
    for cameras in [BY_NERF, BY_COLMAP] {
        let (code, said) = run(directory.path(), cameras, &["-q"]);
        assert_eq!(code, Some(0), "{said}");
        let error = &report(directory.path())["parameter_errors"][0];
        let [start, end] = ["start", "end"].map(|name| error[name].as_f64().unwrap());
        assert!(end < 0.1 * start, "{cameras}: {error}");
    }
}

/// A camera that stands elsewhere sees another picture than the photograph, in whatever format that
/// is: sRGB of 8 bits, with JPEG's losses or without, or linear.
#[test]
fn the_photograph_is_what_its_camera_sees() {
    let directory = studio();
    let at = directory.path();
    let photograph = at.join("photo/image.jpg");
    let file = std::fs::File::create(photograph).unwrap();
    let encoder = image::codecs::jpeg::JpegEncoder::new_with_quality(file, 98);
    let png = image::open(at.join("photo/image.png")).unwrap();
    png.to_rgb8().write_with_encoder(encoder).unwrap();
    let still = [
        "--set",
        "steps=1",
        "--set",
        "render.spp=512",
        "--set",
        "parameters.\"card.translation\".start=[0, 0, 0]",
    ];
    let loss_of = |name: &str, pose: &str| {
        let line = format!("1 {pose} 1 {name}\n\n");
        std::fs::write(at.join("images.txt"), line).unwrap();
        let (code, said) = run(at, BY_COLMAP, &still);
        assert_eq!(code, Some(0), "{said}");
        let first = report(at)["first"].clone();
        ["loss", "error"].map(|name| first[name].as_f64().unwrap())
    };
    let names = ["image.png", "image.jpg", "image.exr"];
    // A format that were misread would have a loss of its own where it was taken, too.
    let own = names.map(|name| loss_of(name, "0 1 0 0 0 0 4"));
    for elsewhere in ["0 1 0 0 0.05 0 4", "0 1 0.02 0 0 0 4"] {
        for [other, other_error] in names.map(|name| loss_of(name, elsewhere)) {
            for [own, error] in own {
                let sigma = error.hypot(other_error);
                assert!(other - own > 4.0 * sigma, "{own}, {other} ± {sigma}");
            }
        }
    }
}

#[test]
fn masks_are_found_and_read() {
    let directory = studio();
    let at = directory.path();
    mask(at, [0, 0]);
    for cameras in [BY_NERF, BY_COLMAP] {
        let (code, said) = run(at, cameras, &[]);
        assert!(
            code == Some(3) && said.contains("mask is black everywhere"),
            "{said}"
        );
    }
    std::fs::rename(at.join("masks/image.png"), at.join("masks/image.png.png")).unwrap();
    let (_, said) = run(at, BY_COLMAP, &[]);
    assert!(said.contains("mask is black everywhere"), "{said}");
    std::fs::remove_dir_all(at.join("masks")).unwrap();
    let (code, said) = run(at, BY_COLMAP, &[]);
    assert!(
        code == Some(3) && said.contains("masks/image.png"),
        "{said}"
    );
}

#[test]
fn pictures_of_one_name_in_two_folders_are_two_cameras() {
    let directory = studio();
    let at = directory.path();
    for folder in ["left", "right"] {
        let folder = at.join("photo").join(folder);
        std::fs::create_dir(&folder).unwrap();
        std::fs::copy(at.join("photo/image.png"), folder.join("1.png")).unwrap();
    }
    let two = "1 0 1 0 0 0 0 4 1 left/1.png\n\n2 0 1 0 0 0 0 4 1 right/1.png\n\n";
    std::fs::write(at.join("images.txt"), two).unwrap();
    let cameras = BY_COLMAP.replace("\nmasks = \"masks\"", "");
    let of_one = [
        "--set",
        "steps=1",
        "--set",
        "parameters.\"right/1.x_fov\".lr=0.1",
    ];
    let (code, said) = run(at, &cameras, &of_one);
    assert_eq!(code, Some(0), "{said}");
    assert!(at.join("out/view-1_right_1.png").exists(), "{said}");
    let twice = "1 0 1 0 0 0 0 4 1 image.png\n\n2 0 1 0 0 0 0 4 1 image.png\n\n";
    std::fs::write(at.join("images.txt"), twice).unwrap();
    let (code, said) = run(at, &cameras, &of_one);
    assert!(
        code == Some(3) && said.contains("two cameras are called \"image\""),
        "{said}"
    );
}

/// Where a mask is what shapes cover, a pixel that is covered in part shows what is behind them,
/// too.
#[test]
fn colours_count_where_shapes_cover_all_of_a_pixel() {
    let directory = studio();
    let at = directory.path();
    mask(at, [255, 128]);
    let photograph = at.join("photo/image.png");
    let own = image::open(&photograph).unwrap().to_rgb8();
    let mut painted = own.clone();
    for (x, _, pixel) in painted.enumerate_pixels_mut() {
        if x >= 20 {
            *pixel = image::Rgb([255, 0, 0]);
        }
    }
    let covers = "loss.silhouette={ shapes = \"floor card\", weight = 1e-9 }";
    let mut losses = Vec::new();
    for picture in [&own, &painted] {
        picture.save(&photograph).unwrap();
        for loss in [covers, "loss.kind=\"l2\""] {
            let (code, said) = run(at, BY_NERF, &["--set", "steps=1", "--set", loss]);
            assert_eq!(code, Some(0), "{said}");
            losses.push(report(at)["first"]["loss"].as_f64().unwrap());
        }
    }
    let [covered, weighed, covered_painted, weighed_painted] = losses[..] else {
        unreachable!()
    };
    assert!((covered_painted / covered - 1.0).abs() < 1e-4, "{losses:?}");
    assert!(weighed_painted > 2.0 * weighed, "{losses:?}");
}
