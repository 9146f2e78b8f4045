//! The film's samples: one shifted lattice a group, cut into tiles.
//!
//! A group of samples puts `columns × rows` points in every pixel, on a regular lattice that is
//! shifted as a whole by one random vector. Every interval between neighbours in a row or a
//! column is a *cell* of the change of variables (`boundary::cells::film::search`); so that the
//! cells cover the tile completely, the lattice has one more point beyond each side of the tile,
//! which belongs to no pixel's sum.

use crate::paths::dimensions::Single;
use crate::paths::random::Stream;
use crate::scene::Rgb;

/// How the samples of one group lie, and how the film is cut into tiles.
#[derive(Clone, Debug)]
pub struct Lattice {
    /// Points a pixel along x and y.
    pub per_pixel: [usize; 2],
    /// Sampled domain in pixels of the crop window: from −border to size + border.
    pub start: [i32; 2],
    pub end: [i32; 2],
    /// Pixels along a tile's sides, at most.
    tile_sides: [usize; 2],
    tiles: [usize; 2],
}

/// A rectangle of pixels: from here up to, not including, there.
pub type Pixels = [[i32; 2]; 2];

/// One tile of one group.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Pixels covered: from `start` up to, not including, `end`.
    pub start: [i32; 2],
    pub end: [i32; 2],
    /// Where the lattice of all tiles starts and ends.
    pub film: [[i32; 2]; 2],
    /// Lattice points along x and y, the two outer ones included.
    pub points: [usize; 2],
    /// Film position of point (0, 0), which lies outside the tile.
    pub first: [f64; 2],
    /// Distance between neighbours in pixels.
    pub step: [f64; 2],
    pub stream: Stream,
    /// That all tiles of the group share.
    pub whole: Stream,
}

/// What the samples of a tile saw: row by row.
pub struct LatticeImage {
    pub triangle: Vec<u32>,
    pub radiance: Vec<Rgb>,
    /// For each delta light, whether it is hidden from what is seen that it could light; empty if
    /// nobody looks for the borders of shadows.
    pub hidden: Vec<Vec<bool>>,
}

/// Points along a tile's side, outer ones included, that we aim for: about 4000 samples a tile keep
/// its store in the second-level cache whatever the number of samples a pixel.
const POINTS_PER_SIDE: usize = 64;
/// And of a tile of a pilot, which is to see all quarters of the film: 1.2 times the points of
/// large tiles, for those on the rims.
const POINTS_PER_SIDE_OF_SMALL: usize = 16;
/// The plastic number's first two powers inverted: their multiples fill a square most evenly.
const PLASTIC: [f64; 2] = [0.754_877_666_246_693, 0.569_840_290_998_053];

impl Lattice {
    /// `samples` points a pixel over the film of `size` pixels and `border` pixels around it.
    pub fn new(samples: u32, size: [u32; 2], border: u32) -> Self {
        Self::in_tiles_of(POINTS_PER_SIDE, samples, size, border)
    }

    /// The same in many small tiles.
    pub fn in_small_tiles(samples: u32, size: [u32; 2], border: u32) -> Self {
        Self::in_tiles_of(POINTS_PER_SIDE_OF_SMALL, samples, size, border)
    }

    fn in_tiles_of(points: usize, samples: u32, size: [u32; 2], border: u32) -> Self {
        let samples = samples.max(1) as usize;
        // The divisor nearest the square root: as square as the number allows.
        let rows = (1..=samples.isqrt())
            .rev()
            .find(|r| samples.is_multiple_of(*r))
            .unwrap_or(1);
        let per_pixel = [samples / rows, rows];
        let start = [-(border as i32); 2];
        let end = size.map(|s| (s + border) as i32);
        let mut lattice = Self {
            per_pixel,
            start,
            end,
            tile_sides: per_pixel.map(|n| ((points - 2) / n).max(1)),
            tiles: [0; 2],
        };
        lattice.tiles = lattice.tiles_over([start, end]);
        lattice
    }

    /// Tiles along both sides of these pixels.
    fn tiles_over(&self, [start, end]: Pixels) -> [usize; 2] {
        [0, 1].map(|i| ((end[i] - start[i]) as usize).div_ceil(self.tile_sides[i]))
    }

    pub fn tile_count(&self) -> usize {
        self.tiles[0] * self.tiles[1]
    }

    /// About this part of the tiles, spread evenly in both directions; one at least.
    pub fn some_tiles(&self, part: f64) -> Vec<usize> {
        let all = 0..self.tile_count();
        let is_taken = |index: &usize| {
            let at = [index % self.tiles[0], index / self.tiles[0]];
            let turns = PLASTIC[0] * at[0] as f64 + PLASTIC[1] * at[1] as f64;
            (turns + 0.5).fract() < part
        };
        let some: Vec<usize> = all.clone().filter(is_taken).collect();
        match some.is_empty() {
            true => vec![all.end / 2],
            false => some,
        }
    }

    /// Tile `index` of group `group`.
    pub fn tile(&self, index: usize, group: u32, seed: u64) -> Tile {
        let own = Stream::new(seed, [group, index as u32]);
        let whole = Stream::new(seed, [group, u32::MAX]);
        self.tile_over(self.pixels_of(index), own, whole)
    }

    /// The pixels of tile `index`.
    pub fn pixels_of(&self, index: usize) -> Pixels {
        nth_part([self.start, self.end], self.tiles, index)
    }

    /// Pixels cut into tiles as large as those of the film.
    pub fn cut(&self, pixels: Pixels) -> impl Iterator<Item = Pixels> + use<> {
        let counts = self.tiles_over(pixels);
        (0..counts[0] * counts[1]).map(move |index| nth_part(pixels, counts, index))
    }

    /// A tile over pixels, with random numbers of its own and those that it shares with all tiles
    /// of the group.
    pub fn tile_over(&self, [start, end]: Pixels, own: Stream, whole: Stream) -> Tile {
        let step = self.per_pixel.map(|n| 1.0 / n as f64);
        // One for all tiles. The weights of a pixel's filter, and their slopes even more, sum up
        // well over a lattice that goes on, and badly over one that is broken at the borders of
        // tiles.
        let shift = [0, 1].map(|axis| whole.single(Single::LatticeShift, [axis, 0, 0]));
        Tile {
            start,
            end,
            film: [self.start, self.end],
            points: std::array::from_fn(|i| (end[i] - start[i]) as usize * self.per_pixel[i] + 2),
            first: std::array::from_fn(|i| start[i] as f64 + (shift[i] as f64 - 1.0) * step[i]),
            step,
            stream: own,
            whole,
        }
    }
}

/// One of so many parts of a rectangle along its sides.
fn nth_part([start, end]: Pixels, counts: [usize; 2], index: usize) -> Pixels {
    let at = [index % counts[0], index / counts[0]];
    let bound = |i: usize, k: usize| {
        let pixels = (end[i] - start[i]) as usize;
        start[i] + (pixels * k / counts[i]) as i32
    };
    [0, 1].map(|further| [0, 1].map(|i| bound(i, at[i] + further)))
}

impl Tile {
    /// Film position of a lattice point along axis `i`.
    pub fn position(&self, i: usize, point: usize) -> f64 {
        self.first[i] + point as f64 * self.step[i]
    }

    /// Whether the lattice point belongs to a pixel of the tile, or only closes its outer cells.
    pub fn is_inner(&self, i: usize, point: usize) -> bool {
        point > 0 && point + 1 < self.points[i]
    }

    /// Whether a film position lies in the tile.
    pub fn contains(&self, [u, v]: [f64; 2]) -> bool {
        u >= self.start[0] as f64
            && u < self.end[0] as f64
            && v >= self.start[1] as f64
            && v < self.end[1] as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A part of the film is that part, in all directions, and never nothing.
    #[test]
    fn a_part_of_the_film_lies_all_over_it() {
        let lattice = Lattice::in_small_tiles(4, [128, 96], 2);
        let [columns, rows] = lattice.tiles;
        for part in [0.5, 0.25, 0.125] {
            let taken = lattice.some_tiles(part);
            let share = |is_there: &dyn Fn([usize; 2]) -> bool| {
                let all =
                    (0..lattice.tile_count()).filter(|i| is_there([i % columns, i / columns]));
                let some = taken
                    .iter()
                    .filter(|&&i| is_there([i % columns, i / columns]));
                some.count() as f64 / all.count() as f64
            };
            let whole = share(&|_| true);
            assert!((whole / part - 1.0).abs() < 0.1, "{part}: {whole}");
            for right in [false, true] {
                for lower in [false, true] {
                    let quarter = |[x, y]: [usize; 2]| {
                        (2 * x >= columns) == right && (2 * y >= rows) == lower
                    };
                    let share = share(&quarter);
                    assert!((share / part - 1.0).abs() < 0.3, "{part}: {share}");
                }
            }
        }
        assert_eq!(lattice.some_tiles(1e-9).len(), 1);
    }
}
