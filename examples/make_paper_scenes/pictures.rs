//! The sky with its sun, the tiles, and the direction in which the tiles change.

use crate::chance::between;
use crate::shapes::dot;
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::path::Path;
use warpath::methods::Image;
use warpath::output::{exr, npy, png};

/// A dim sky, brighter towards its zenith (the first row), and a disc of four degrees across, ten
/// thousand times as bright, in the direction of `SUN`.
pub fn sun(path: &Path) -> Result<(), Box<dyn Error>> {
    const SIZE: [usize; 2] = [256, 128];
    const SUN: [f64; 3] = [0.55, 0.75, 0.37];
    const RADIUS_RAD: f64 = 2.0 * PI / 180.0;
    let length = dot(SUN, SUN).sqrt();
    let pixels = (0..SIZE[0] * SIZE[1]).map(|i| {
        let (column, row) = (i % SIZE[0], i / SIZE[0]);
        // The part of the texel that the disc covers, by a grid of points in it.
        let mut covered = 0.0;
        for k in 0..256 {
            let u = (column as f64 + (k % 16) as f64 / 16.0 + 1.0 / 32.0) / SIZE[0] as f64;
            // Rows stand at whole steps from pole to pole.
            let v = (row as f64 + (k / 16) as f64 / 16.0 - 15.0 / 32.0) / (SIZE[1] - 1) as f64;
            let (sin, cos) = (PI * v).sin_cos();
            let to = [(TAU * u).sin() * sin, cos, -(TAU * u).cos() * sin];
            if dot(to, SUN) > length * RADIUS_RAD.cos() {
                covered += 1.0 / 256.0;
            }
        }
        let up = (PI * row as f64 / (SIZE[1] - 1) as f64).cos().max(0.0);
        let sky = [0.06 + 0.04 * up, 0.08 + 0.06 * up, 0.12 + 0.10 * up];
        let disc = [1000.0, 900.0, 750.0];
        std::array::from_fn(|c| (sky[c] + covered * disc[c]) as f32)
    });
    let image = Image {
        width: SIZE[0],
        height: SIZE[1],
        pixels: pixels.collect(),
    };
    Ok(exr::write(path, &image)?)
}

const TILES: usize = 32;

/// Squares of uneven colours, 8×8 of 4×4 texels each.
pub fn tiles(path: &Path) -> Result<(), Box<dyn Error>> {
    let pixels = (0..TILES * TILES).map(|i| {
        let tile = (i / TILES / 4 * 8 + i % TILES / 4) as u64;
        let grey = between(0.15, 0.6, tile, 2);
        std::array::from_fn(|c| (grey + between(-0.1, 0.15, tile, 3 + c as u64)) as f32)
    });
    let image = Image {
        width: TILES,
        height: TILES,
        pixels: pixels.collect(),
    };
    Ok(png::write_image(path, &image)?)
}

/// A ring of texels that grow brighter while those in it grow darker: both signs, and edges in the
/// tangent.
pub fn tiles_tangent(path: &Path) -> Result<(), Box<dyn Error>> {
    let values = (0..TILES * TILES * 3).map(|i| {
        let (texel, channel) = (i / 3, i % 3);
        let from_centre = |x: usize| x as f64 + 0.5 - TILES as f64 / 2.0;
        let r = from_centre(texel % TILES).hypot(from_centre(texel / TILES));
        let colour = [1.0, 0.6, 0.3][channel];
        match r {
            r if r < 6.0 => -colour as f32,
            r if r < 11.0 => colour as f32,
            _ => 0.0,
        }
    });
    Ok(npy::write(path, &[TILES, TILES, 3], values)?)
}
