//! A view in one picture: at the start, now, its target, and their difference.

use crate::jobs::failure::Failure;
use crate::output::chart::robust_scale;
use crate::output::colormap::diverging;
use crate::output::png;
use crate::picture::Image;

/// Columns of white between images.
const GAP: usize = 4;

/// Rows of RGB bytes side by side.
pub struct Strip {
    pub width: usize,
    pub height: usize,
    pub rgb: Vec<u8>,
}

impl Strip {
    /// Of images of one size. The difference is now minus target where pixels count, red where the
    /// image is too bright, its scale that of its largest numbers.
    pub fn new([start, now, target]: [&Image; 3], weights: Option<&[f32]>) -> Self {
        let pairs = now.pixels.iter().zip(&target.pixels).enumerate();
        let weight = |i: usize| weights.map_or(1.0, |weights| weights[i]);
        let difference = Image {
            width: target.width,
            height: target.height,
            pixels: pairs
                .map(|(i, (a, b))| [0, 1, 2].map(|c| weight(i) * (a[c] - b[c])))
                .collect(),
        };
        // What is darker than a hundredth of the target's brightest is not worth a colour.
        let brightest = target
            .pixels
            .iter()
            .flatten()
            .fold(0.0f32, |m, v| m.max(*v));
        let scale = robust_scale(&difference).max(0.01 * brightest).max(1e-12);
        let coloured = difference
            .pixels
            .iter()
            .flat_map(|p| diverging((p[0] + p[1] + p[2]) / 3.0 / scale));
        let parts = [
            png::srgb_bytes(start),
            png::srgb_bytes(now),
            png::srgb_bytes(target),
            coloured.collect(),
        ];
        side_by_side(&parts, target.width, target.height)
    }

    /// The bytes of a PNG.
    pub fn png(&self) -> Result<Vec<u8>, Failure> {
        png::file_of(self.width, self.height, &self.rgb)
            .map_err(|error| Failure::System(error.to_string()))
    }
}

fn side_by_side(parts: &[Vec<u8>], width: usize, height: usize) -> Strip {
    let whole = parts.len() * width + (parts.len() - 1) * GAP;
    let mut rgb = Vec::with_capacity(3 * whole * height);
    for y in 0..height {
        for (i, part) in parts.iter().enumerate() {
            if i > 0 {
                rgb.resize(rgb.len() + 3 * GAP, 255);
            }
            rgb.extend(&part[3 * y * width..3 * (y + 1) * width]);
        }
    }
    Strip {
        width: whole,
        height,
        rgb,
    }
}
