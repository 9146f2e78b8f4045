//! OpenEXR, however it is coded.

use super::{WIDE, auto, through_file};
use common::picture_files::*;
use warpath::picture::{Colours, Encoding};

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
