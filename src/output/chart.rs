//! Gradient images as pictures: a diverging colour map symmetric about zero, with its scale in the
//! picture.

use super::colormap::diverging;
use super::error::FileError;
use super::{glyphs, png};
use crate::picture::Image;
use std::path::Path;

/// Small images are enlarged by a whole factor until they are at least this wide, so that single
/// pixels can be seen and the scale's labels fit.
const LEAST_WIDTH: usize = 256;
/// Rows of the colour bar, and the margin around it and its labels.
const BAR: usize = 10;
const MARGIN: usize = 6;
/// Colours of the labels and of the ground.
const INK: [u8; 3] = [30, 30, 30];
const PAPER: [u8; 3] = [255, 255, 255];

/// Writes the mean of `image`'s channels, `scale` being the deepest colour: above it, as for
/// outliers, colours saturate.
pub fn write(path: &Path, image: &Image, scale: f32) -> Result<(), FileError> {
    let canvas = draw(image, scale);
    let comment = format!(
        "mean of the channels; the colours span -{} to +{}",
        label(scale),
        label(scale)
    );
    png::write_bytes(
        path,
        canvas.width,
        canvas.height,
        &canvas.bytes,
        Some(&comment),
    )
}

/// A scale for [`write()`]: the 99.5th percentile of the magnitudes that are not zero, rounded up
/// to two digits. A few fireflies do not wash the rest out; a mostly black image is not judged by
/// its black.
pub fn robust_scale(image: &Image) -> f32 {
    let mut magnitudes: Vec<f32> = image
        .pixels
        .iter()
        .map(|p| mean(p).abs())
        .filter(|v| *v > 0.0)
        .collect();
    if magnitudes.is_empty() {
        return 0.0;
    }
    let at = (magnitudes.len() - 1) * 995 / 1000;
    let (_, value, _) = magnitudes.select_nth_unstable_by(at, f32::total_cmp);
    rounded_up(*value)
}

fn rounded_up(value: f32) -> f32 {
    let unit = 10f64.powf((value as f64).log10().floor() - 1.0);
    let rounded = ((value as f64 / unit - 1e-6).ceil() * unit) as f32;
    if rounded.is_finite() && rounded > 0.0 {
        rounded
    } else {
        value
    }
}

fn mean(pixel: &[f32; 3]) -> f32 {
    (pixel[0] + pixel[1] + pixel[2]) / 3.0
}

/// Two digits: `0.12`, `7.5`, `3.1e-5`.
fn label(scale: f32) -> String {
    match scale {
        0.0 => "0".into(),
        s if (0.01..100.0).contains(&s) => {
            let decimals = (1.0 - s.log10().floor()).max(0.0) as usize;
            format!("{s:.decimals$}")
        }
        s => format!("{s:.1e}"),
    }
}

struct Canvas {
    width: usize,
    height: usize,
    bytes: Vec<u8>,
}

impl Canvas {
    fn new(width: usize, height: usize) -> Self {
        Self {
            width,
            height,
            bytes: PAPER.repeat(width * height),
        }
    }

    fn dot(&mut self, x: usize, y: usize, colour: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = (y * self.width + x) * 3;
            self.bytes[at..at + 3].copy_from_slice(&colour);
        }
    }

    fn text(&mut self, x: usize, y: usize, text: &str) {
        for (i, character) in text.chars().enumerate() {
            for (row, bits) in glyphs::rows(character).into_iter().enumerate() {
                for column in (0..glyphs::SIZE.0)
                    .filter(|column| bits >> (glyphs::SIZE.0 - 1 - column) & 1 == 1)
                {
                    self.dot(x + i * (glyphs::SIZE.0 + 1) + column, y + row, INK);
                }
            }
        }
    }
}

fn text_width(text: &str) -> usize {
    text.len() * (glyphs::SIZE.0 + 1) - 1
}

fn draw(image: &Image, scale: f32) -> Canvas {
    let factor = LEAST_WIDTH.div_ceil(image.width.max(1)).max(1);
    let (width, height) = (image.width * factor, image.height * factor);
    let bar_top = height + MARGIN;
    let text_top = bar_top + BAR + MARGIN / 2;
    let mut canvas = Canvas::new(width, text_top + glyphs::SIZE.1 + MARGIN);
    let per_unit = if scale > 0.0 { 1.0 / scale } else { 0.0 };
    for y in 0..height {
        for x in 0..width {
            let pixel = &image.pixels[y / factor * image.width + x / factor];
            canvas.dot(x, y, diverging(mean(pixel) * per_unit));
        }
    }
    let (left, right) = (MARGIN, width.saturating_sub(MARGIN));
    let middle = (left + right) / 2;
    for x in left..right {
        let t = (x as f32 - middle as f32) / (right - middle).max(1) as f32;
        for y in bar_top..bar_top + BAR {
            canvas.dot(x, y, diverging(t));
        }
    }
    for y in bar_top..bar_top + BAR {
        for x in [left, middle, right.saturating_sub(1)] {
            canvas.dot(x, y, INK);
        }
    }
    let high = format!("+{}", label(scale));
    canvas.text(left, text_top, &format!("-{}", label(scale)));
    canvas.text(middle - glyphs::SIZE.0 / 2, text_top, "0");
    canvas.text(right.saturating_sub(text_width(&high)), text_top, &high);
    canvas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_have_two_digits() {
        let known = [
            (0.0, "0"),
            (0.12, "0.12"),
            (7.5, "7.5"),
            (42.0, "42"),
            (3.1e-5, "3.1e-5"),
            (1.2e6, "1.2e6"),
            (0.031, "0.031"),
        ];
        for (scale, text) in known {
            assert_eq!(label(scale), text);
        }
    }

    #[test]
    fn the_scale_ignores_outliers_and_black() {
        let mut image = Image {
            width: 100,
            height: 100,
            pixels: vec![[0.0; 3]; 10_000],
        };
        for (i, pixel) in image.pixels.iter_mut().take(1000).enumerate() {
            *pixel = [if i % 2 == 0 { 0.1234 } else { -0.1234 }; 3];
        }
        image.pixels[5000] = [1e6; 3];
        assert_eq!(robust_scale(&image), 0.13);
        assert_eq!(
            robust_scale(&Image {
                width: 1,
                height: 1,
                pixels: vec![[0.0; 3]]
            }),
            0.0
        );
    }

    #[test]
    fn the_picture_is_symmetric_and_enlarged() {
        let image = Image {
            width: 3,
            height: 1,
            pixels: vec![[-1.0; 3], [0.0; 3], [1.0; 3]],
        };
        let canvas = draw(&image, 1.0);
        assert_eq!(canvas.width, 258);
        let at = |x: usize| {
            [
                canvas.bytes[x * 3],
                canvas.bytes[x * 3 + 1],
                canvas.bytes[x * 3 + 2],
            ]
        };
        assert_eq!(
            [at(0), at(100), at(257)],
            [diverging(-1.0), diverging(0.0), diverging(1.0)]
        );
    }
}
