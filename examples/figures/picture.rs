//! Gradient, reference and difference side by side, in the colours of one scale.

use crate::Result;
use std::path::Path;
use warpath::methods::Image;
use warpath::output::chart;

/// Small images are enlarged by a whole factor until they are at least so wide.
const LEAST_WIDTH: usize = 256;
const GAP: usize = 4;

/// Writes a PNG of the three; each is height × width × 3.
pub fn write(path: &Path, size: [usize; 2], gradient: &[f32], reference: &[f32]) -> Result<()> {
    let difference: Vec<f32> = gradient.iter().zip(reference).map(|(a, b)| a - b).collect();
    let image = |values: &[f32]| Image {
        width: size[0],
        height: size[1],
        pixels: values.as_chunks::<3>().0.to_vec(),
    };
    let panels = [gradient, reference, &difference].map(image);
    let scale = chart::robust_scale(&panels[1]);
    chart::write(path, &beside(&panels), scale)?;
    Ok(())
}

fn beside(panels: &[Image; 3]) -> Image {
    let factor = LEAST_WIDTH.div_ceil(panels[0].width).max(1);
    let (width, height) = (panels[0].width * factor, panels[0].height * factor);
    let whole = 3 * width + 2 * GAP;
    // What is not a number is drawn black.
    let mut pixels = vec![[f32::NAN; 3]; whole * height];
    for (k, panel) in panels.iter().enumerate() {
        for y in 0..height {
            let row = y * whole + k * (width + GAP);
            for x in 0..width {
                pixels[row + x] = panel.pixels[y / factor * panel.width + x / factor];
            }
        }
    }
    Image {
        width: whole,
        height,
        pixels,
    }
}
