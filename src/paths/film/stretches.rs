//! Pixels' shares of a straight piece of film, before filters that jump.

use crate::paths::boundary_sample::Piece;
use crate::paths::film::filter::{FilmFilter, Taps};

impl FilmFilter {
    /// Calls with the share of each stretch of a piece of film in which the weights of a box are
    /// the same, its middle, and the weights along both axes.
    pub fn along(
        &self,
        at: [f64; 2],
        piece: &Piece,
        mut call: impl FnMut(f32, [f64; 2], [&Taps; 2]),
    ) {
        let half = piece.half;
        let mut call_at = |share: f64, s: f64| {
            let at = [0, 1].map(|i| at[i] + s * half[i]);
            let [x, y] = [0, 1].map(|i| self.taps(i, at[i]));
            call(share as f32, at, [&x, &y]);
        };
        let [mut from, to] = piece.part;
        if half == [0.0; 2] {
            return call_at(0.5 * (to - from), 0.0);
        }
        while from < to {
            // The taps change where u ± radius − ½ is whole.
            let until = [0, 1]
                .into_iter()
                .flat_map(|i| [-1.0, 1.0].map(|side| (i, side * self.radius - 0.5)))
                .map(|(i, shift)| next_whole(at[i] + shift, half[i], from))
                .fold(to, f64::min);
            call_at(0.5 * (until - from), 0.5 * (from + until));
            from = until;
        }
    }
}

/// The least s beyond `from` at which `start` + s·`slope` is whole.
fn next_whole(start: f64, slope: f64, from: f64) -> f64 {
    /// Stretches that are shorter bring nothing.
    const LEAST: f64 = 1e-9;
    if slope == 0.0 {
        return f64::INFINITY;
    }
    let (beyond, up) = (start + (from + LEAST) * slope, slope > 0.0);
    let whole = if up { beyond.ceil() } else { beyond.floor() };
    ((whole - start) / slope).max(from + LEAST)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paths::film::filter::Block;
    use crate::paths::film::lattice::Lattice;
    use crate::scene::Filter;

    const SIZE: [u32; 2] = [5, 4];

    fn filters() -> [FilmFilter; 2] {
        let lattice = Lattice::new(4, SIZE, 0);
        [0.5, 0.8].map(|radius| FilmFilter::new(Filter::Box { radius }, SIZE, &lattice))
    }

    fn picture(add: impl FnOnce(&mut dyn FnMut(f32, [f64; 2], [&Taps; 2]))) -> Vec<f32> {
        let [width, height] = SIZE.map(|s| s as usize);
        let mut block = Block {
            start: [0; 2],
            size: [width, height],
            pixels: vec![[0.0; 3]; width * height],
        };
        add(&mut |share, _, [x, y]| block.add_point(x, y, [share; 3]));
        block.pixels.iter().map(|p| p[0]).collect()
    }

    /// A piece is the mean of its points.
    #[test]
    fn a_piece_is_the_mean_of_its_points() {
        const POINTS: usize = 4000;
        let part = [-1.0, 1.0];
        for filter in filters() {
            for (at, half) in [
                ([2.3, 1.4], [0.125, 0.9]),
                ([2.0, 1.98], [-0.6, 0.125]),
                ([3.5, 2.5], [0.0, 0.5]),
            ] {
                let exact = picture(|add| filter.along(at, &Piece { half, part }, add));
                let points = picture(|add| {
                    for k in 0..POINTS {
                        let s = (k as f64 + 0.5) / POINTS as f64 * 2.0 - 1.0;
                        let at = [0, 1].map(|i| at[i] + s * half[i]);
                        let [x, y] = [0, 1].map(|i| filter.taps(i, at[i]));
                        add(1.0 / POINTS as f32, at, [&x, &y]);
                    }
                });
                for (a, b) in exact.iter().zip(&points) {
                    assert!((a - b).abs() < 1e-3, "{at:?} {half:?}: {a} {b}");
                }
            }
        }
    }
}
