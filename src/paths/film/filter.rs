//! Reconstruction filters over a lattice: samples to pixels, and an adjoint image back to samples.
//!
//! I_j = ∫h_j(u) L(u) du / ∫h_j(u) du over the sampled domain. The lattice is a product and so are
//! the filters: every row of samples is filtered along x first and then added to the pixel rows it
//! reaches.

use crate::paths::film::lattice::{Lattice, Tile};
use crate::scene::{Filter, Rgb};

/// Pixels that one sample can reach along an axis.
const MAX_REACH: usize = 9;

/// A filter over the whole film.
#[derive(Clone, Debug)]
pub struct FilmFilter {
    pub filter: Filter,
    pub(super) radius: f64,
    size: [usize; 2],
    /// 1/∫h_j along each axis, a pixel at a time.
    normalisation: [Vec<f64>; 2],
}

/// The weights of one lattice point along one axis: of pixels `first`, `first`+1, …
#[derive(Clone, Copy, Debug)]
pub struct Taps {
    first: usize,
    count: usize,
    weight: [f32; MAX_REACH],
}

impl FilmFilter {
    pub fn new(filter: Filter, size: [u32; 2], lattice: &Lattice) -> Self {
        let radius = filter.radius();
        // That of all pixels but those near the film's border.
        let whole = filter.integral(-radius, radius);
        let normalisation = std::array::from_fn(|i| {
            (0..size[i])
                .map(|j| {
                    let centre = j as f64 + 0.5;
                    let (from, to) = (
                        lattice.start[i] as f64 - centre,
                        lattice.end[i] as f64 - centre,
                    );
                    if from <= -radius && to >= radius {
                        return 1.0 / whole;
                    }
                    1.0 / filter.integral(from.max(-radius), to.min(radius))
                })
                .collect()
        });
        Self {
            filter,
            radius,
            size: size.map(|s| s as usize),
            normalisation,
        }
    }

    /// Pixels around the film whose samples reach it.
    pub fn border(filter: Filter) -> u32 {
        (filter.radius() - 0.5 - 1e-3).ceil().max(0.0) as u32
    }

    /// Pixels between one and the farthest whose samples reach it: even if they are carried on by
    /// up to half a pixel, as differences do before continuous filters, and if what they found
    /// stands for a piece of an outline, which is up to a pixel long and made before others.
    pub fn reach(&self) -> i32 {
        match self.filter.is_continuous() {
            true => self.radius.ceil() as i32,
            false => Self::border(self.filter) as i32 + 1,
        }
    }

    /// Normalised weights at film position `u` along axis `i`, per pixel of film.
    pub fn taps(&self, i: usize, u: f64) -> Taps {
        self.taps_by(i, u, Filter::value)
    }

    /// How [`FilmFilter::taps`] change with `u`.
    pub fn slopes(&self, i: usize, u: f64) -> Taps {
        self.taps_by(i, u, Filter::slope)
    }

    fn taps_by(&self, i: usize, u: f64, of: impl Fn(Filter, f64) -> f64) -> Taps {
        // Pixel j is reached if |u − (j + ½)| < radius; a box is half open so that it tiles.
        let low = (u - self.radius - 0.5).floor() as i64 + 1;
        let high = (u + self.radius - 0.5).floor() as i64;
        let first = low.max(0) as usize;
        let end = ((high + 1).max(0) as usize).min(self.size[i]);
        let mut taps = Taps {
            first,
            count: end.saturating_sub(first).min(MAX_REACH),
            weight: [0.0; MAX_REACH],
        };
        for k in 0..taps.count {
            let j = first + k;
            taps.weight[k] =
                (of(self.filter, u - (j as f64 + 0.5)) * self.normalisation[i][j]) as f32;
        }
        taps
    }

    /// The weights of all lattice points of a tile along axis `i`, times their spacing; outer
    /// points get none.
    pub fn tile_taps(&self, tile: &Tile, i: usize) -> Vec<Taps> {
        self.of_tile(tile, i, |u| self.taps(i, u))
    }

    /// Likewise of [`FilmFilter::slopes`].
    pub fn tile_slopes(&self, tile: &Tile, i: usize) -> Vec<Taps> {
        self.of_tile(tile, i, |u| self.slopes(i, u))
    }

    fn of_tile(&self, tile: &Tile, i: usize, taps: impl Fn(f64) -> Taps) -> Vec<Taps> {
        (0..tile.points[i])
            .map(|p| {
                if !tile.is_inner(i, p) {
                    return Taps {
                        first: 0,
                        count: 0,
                        weight: [0.0; MAX_REACH],
                    };
                }
                let mut taps = taps(tile.position(i, p));
                taps.weight
                    .iter_mut()
                    .for_each(|w| *w *= tile.step[i] as f32);
                taps
            })
            .collect()
    }
}

impl Taps {
    /// Over all pixels.
    pub fn sum(&self) -> f64 {
        self.iter().map(|(_, w)| f64::from(w)).sum()
    }

    /// Likewise.
    pub fn sum_of_squares(&self) -> f64 {
        self.iter().map(|(_, w)| f64::from(w).powi(2)).sum()
    }

    fn iter(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        (0..self.count).map(|k| (self.first + k, self.weight[k]))
    }
}

impl Filter {
    /// Whether it has no jump.
    pub fn is_continuous(self) -> bool {
        !matches!(self, Filter::Box { .. })
    }

    /// Half the filter's support in pixels.
    pub fn radius(self) -> f64 {
        match self {
            Filter::Box { radius } | Filter::Tent { radius } => radius as f64,
            Filter::Gaussian { stddev } => 4.0 * stddev as f64,
        }
    }

    /// Unnormalised value at distance `x` in pixels.
    fn value(self, x: f64) -> f64 {
        match self {
            Filter::Box { .. } => 1.0,
            Filter::Tent { radius } => (1.0 - (x / radius as f64).abs()).max(0.0),
            Filter::Gaussian { stddev } => {
                let s = stddev as f64;
                ((-0.5 * (x / s).powi(2)).exp() - (-8.0f64).exp()).max(0.0)
            }
        }
    }

    /// The derivative of the value.
    fn slope(self, x: f64) -> f64 {
        match self {
            Filter::Box { .. } => 0.0,
            Filter::Tent { radius } => -x.signum() / f64::from(radius),
            Filter::Gaussian { stddev } => {
                let s = f64::from(stddev);
                -x / (s * s) * (-0.5 * (x / s).powi(2)).exp()
            }
        }
    }

    /// ∫value over [from, to] inside the support, by Simpson's rule on pieces that contain no kink.
    fn integral(self, from: f64, to: f64) -> f64 {
        const PIECES: usize = 512;
        let simpson = |a: f64, b: f64| {
            let h = (b - a) / (2 * PIECES) as f64;
            let sum: f64 = (0..=2 * PIECES)
                .map(|k| {
                    let weight = if k == 0 || k == 2 * PIECES {
                        1.0
                    } else {
                        2.0 + 2.0 * (k % 2) as f64
                    };
                    weight * self.value(a + k as f64 * h)
                })
                .sum();
            sum * h / 3.0
        };
        if from < 0.0 && to > 0.0 {
            simpson(from, 0.0) + simpson(0.0, to)
        } else {
            simpson(from, to)
        }
    }
}

/// RGB values over a rectangle of pixels: a tile's part of an image.
#[derive(Clone, Debug)]
pub struct Block {
    pub start: [usize; 2],
    pub size: [usize; 2],
    pub pixels: Vec<Rgb>,
}

impl Block {
    /// The pixels that samples of the tile can reach.
    pub fn new(filter: &FilmFilter, tile: &Tile) -> Self {
        let reach = filter.radius.ceil() as i64 + 1;
        let start = std::array::from_fn(|i| (tile.start[i] as i64 - reach).max(0) as usize);
        let size = std::array::from_fn(|i| {
            let end = (tile.end[i] as i64 + reach).clamp(0, filter.size[i] as i64) as usize;
            end.saturating_sub(start[i])
        });
        Self {
            start,
            size,
            pixels: vec![[0.0; 3]; size[0] * size[1]],
        }
    }

    /// Adds the block to an image that is `width` pixels wide.
    pub fn add_to(&self, image: &mut [Rgb], width: usize) {
        for (row, values) in self.pixels.chunks_exact(self.size[0].max(1)).enumerate() {
            let at = (self.start[1] + row) * width + self.start[0];
            for (pixel, value) in image[at..at + self.size[0]].iter_mut().zip(values) {
                for c in 0..3 {
                    pixel[c] += value[c];
                }
            }
        }
    }

    /// Adds a row of lattice samples; `values[c]` belongs to `x_taps[c]`.
    pub fn add_row(&mut self, x_taps: &[Taps], y_taps: &Taps, values: &[Rgb]) {
        if y_taps.count == 0 || self.size[0] == 0 {
            return;
        }
        let mut row = vec![[0.0f32; 3]; self.size[0]];
        for (taps, value) in x_taps.iter().zip(values) {
            for (j, w) in taps.iter() {
                let pixel = &mut row[j - self.start[0]];
                for c in 0..3 {
                    pixel[c] += w * value[c];
                }
            }
        }
        for (j, w) in y_taps.iter() {
            let at = (j - self.start[1]) * self.size[0];
            for (pixel, value) in self.pixels[at..at + self.size[0]].iter_mut().zip(&row) {
                for c in 0..3 {
                    pixel[c] += w * value[c];
                }
            }
        }
    }

    /// Adds `value` at one film position, weighted by the filters only.
    pub fn add_point(&mut self, x_taps: &Taps, y_taps: &Taps, value: Rgb) {
        for (jy, wy) in y_taps.iter() {
            for (jx, wx) in x_taps.iter() {
                let pixel =
                    &mut self.pixels[(jy - self.start[1]) * self.size[0] + jx - self.start[0]];
                for c in 0..3 {
                    pixel[c] += wx * wy * value[c];
                }
            }
        }
    }
}

/// What [`Block::add_row`] multiplies each value with, given the cotangents of all pixels: Σ_j w_j
/// Ī_j.
pub fn gather_row(
    adjoint: &[Rgb],
    width: usize,
    x_taps: &[Taps],
    y_taps: &Taps,
    out: &mut Vec<Rgb>,
) {
    out.clear();
    out.resize(x_taps.len(), [0.0; 3]);
    if y_taps.count == 0 {
        return;
    }
    let low = x_taps
        .iter()
        .filter(|t| t.count > 0)
        .map(|t| t.first)
        .min()
        .unwrap_or(0);
    let high = x_taps.iter().map(|t| t.first + t.count).max().unwrap_or(0);
    let mut row = vec![[0.0f32; 3]; high.saturating_sub(low)];
    for (j, w) in y_taps.iter() {
        for (sum, pixel) in row.iter_mut().zip(&adjoint[j * width + low..]) {
            for c in 0..3 {
                sum[c] += w * pixel[c];
            }
        }
    }
    for (taps, value) in x_taps.iter().zip(out) {
        for (j, w) in taps.iter() {
            for c in 0..3 {
                value[c] += w * row[j - low][c];
            }
        }
    }
}

/// What [`Block::add_point`] multiplies its value with.
pub fn gather_point(adjoint: &[Rgb], width: usize, x_taps: &Taps, y_taps: &Taps) -> Rgb {
    let mut sum = [0.0; 3];
    for (jy, wy) in y_taps.iter() {
        for (jx, wx) in x_taps.iter() {
            for c in 0..3 {
                sum[c] += wx * wy * adjoint[jy * width + jx][c];
            }
        }
    }
    sum
}
