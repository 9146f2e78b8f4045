//! PNG, JPEG, HDR and PFM.

use super::{auto, raw, through_file};
use common::picture_files::*;
use warpath::picture::{Colours, Encoding, srgb_to_linear};

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

/// Two rows of three texels, coded by hand: bottom up, blue first.
#[test]
fn bmp_and_tga_are_srgb() {
    let rows: [[[u8; 3]; 3]; 2] = [
        [[1, 2, 3], [40, 50, 60], [255, 0, 128]],
        [[7, 8, 9], [200, 100, 0], [11, 22, 33]],
    ];
    let turned = |[r, g, b]: [u8; 3]| [b, g, r];
    let below_first = rows.iter().rev();
    let mut bmp = b"BM".to_vec();
    for number in [54 + 24u32, 0, 54, 40, 3, 2, 1 | 24 << 16, 0, 24, 0, 0, 0, 0] {
        bmp.extend(number.to_le_bytes());
    }
    for row in below_first.clone() {
        bmp.extend(row.map(turned).as_flattened());
        // Rows end at multiples of four bytes.
        bmp.extend([0; 3]);
    }
    let mut tga = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 3, 0, 2, 0, 24, 0];
    for row in below_first {
        tga.extend(row.map(turned).as_flattened());
    }
    for (name, bytes) in [("a.bmp", bmp), ("a.tga", tga)] {
        let picture = auto(name, &bytes);
        assert_eq!((picture.width, picture.height), (3, 2), "{name}");
        let wanted = rows
            .as_flattened()
            .iter()
            .map(|texel| texel.map(linear_byte));
        assert_eq!(picture.pixels, wanted.collect::<Vec<_>>(), "{name}");
        assert_eq!(warpath::picture::size_of(&bytes), Some([3, 2]), "{name}");
        for length in [20, bytes.len() - 5] {
            let cut = through_file(name, &bytes[..length], Colours::Auto);
            assert!(cut.is_err(), "{name} of {length} bytes: {cut:?}");
        }
    }
}
