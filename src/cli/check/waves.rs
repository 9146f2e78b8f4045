//! The image by which forward and backward are compared.

use crate::jobs::seeds::SEED_STEP;
use crate::methods::Image;

/// An adjoint image with no symmetry by which mistakes could cancel: a few slow waves per channel.
pub fn smooth_image(width: usize, height: usize, seed: u64) -> Image {
    let phase = |n: u64| {
        let mixed = (seed ^ (n + 1).wrapping_mul(SEED_STEP)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed >> 40) as f64 / (1u64 << 24) as f64 * std::f64::consts::TAU
    };
    let wave = |u: f64, v: f64, channel: u64| {
        let terms = (0..4u64).map(|k| {
            let (across, down) = (1.0 + k as f64, 0.7 + (3 - k) as f64);
            (across * u * 3.0 + down * v * 3.0 + phase(4 * channel + k)).cos()
        });
        (1.0 + 0.5 * terms.sum::<f64>()) as f32
    };
    let pixels = (0..width * height)
        .map(|at| {
            let (u, v) = (
                (at % width) as f64 / width as f64,
                (at / width) as f64 / height as f64,
            );
            std::array::from_fn(|channel| wave(u, v, channel as u64))
        })
        .collect();
    Image {
        width,
        height,
        pixels,
    }
}
