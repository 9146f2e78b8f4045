//! How densely blocks of the film are sampled.
//!
//! Samples are best spent where an image has noise. A block of pixels with another density has a
//! lattice of its own. Its pixels take nothing from other lattices, and so that they lack nothing
//! its lattice goes on beyond the block as far as a pixel's filter reaches. So every pixel is what
//! it is on a film that is sampled evenly, whatever is done elsewhere.

use crate::paths::film::filter::Block;
use crate::paths::film::lattice::Pixels;
use crate::scene::Rgb;

/// The samples of a group in each pixel, by blocks.
#[derive(Clone, Debug, PartialEq)]
pub struct DensityMap {
    /// Pixels along a block's side.
    side: usize,
    /// Blocks of a row.
    columns: usize,
    /// The film in pixels.
    size: [usize; 2],
    samples: Vec<u32>,
}

impl DensityMap {
    /// `samples` of blocks of `side` × `side` pixels from the film's first on, row by row; the last
    /// ones may be cut off.
    pub fn new(size: [usize; 2], side: usize, samples: Vec<u32>) -> Self {
        let columns = size[0].div_ceil(side);
        assert_eq!(samples.len(), columns * size[1].div_ceil(side));
        Self {
            side,
            columns,
            size,
            samples,
        }
    }

    /// All densities that occur, rising.
    pub fn all(&self) -> Vec<u32> {
        let mut all = self.samples.clone();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn at(&self, pixel: [usize; 2]) -> u32 {
        let [x, y] = pixel.map(|p| p / self.side);
        self.samples[y * self.columns + x]
    }

    /// Blackens the pixels that have another density than this.
    pub fn keep_only(&self, samples: u32, block: &mut Block) {
        let width = block.size[0];
        for (i, pixel) in block.pixels.iter_mut().enumerate() {
            let at = [block.start[0] + i % width, block.start[1] + i / width];
            if self.at(at) != samples {
                *pixel = [0.0; 3];
            }
        }
    }

    /// An image without the pixels that have another density than this.
    pub fn only(&self, samples: u32, pixels: &[Rgb]) -> Vec<Rgb> {
        let width = self.size[0];
        let is_own = |i: usize| self.at([i % width, i / width]) == samples;
        let pixels = pixels.iter().enumerate();
        pixels
            .map(|(i, pixel)| if is_own(i) { *pixel } else { [0.0; 3] })
            .collect()
    }

    /// What pixels with this density take from, if it is at most `reach` pixels away and on this
    /// film: rectangles that do not overlap.
    pub fn needed(&self, samples: u32, film: Pixels, reach: i32) -> Vec<Pixels> {
        rectangles(&self.reached(samples, film, reach), film)
    }

    /// Whether pixels with this density take from each of the film's, row by row.
    fn reached(&self, samples: u32, [start, end]: Pixels, reach: i32) -> Vec<bool> {
        let [columns, rows] = [0, 1].map(|i| (end[i] - start[i]) as usize);
        let mut reached = vec![false; columns * rows];
        let blocks = self.samples.iter().enumerate();
        for (block, _) in blocks.filter(|(_, own)| **own == samples) {
            let at = [block % self.columns, block / self.columns];
            let bound = |i: usize, further: usize| {
                let edge = ((at[i] + further) * self.side).min(self.size[i]) as i32;
                let edge = edge + reach * (2 * further as i32 - 1);
                (edge.clamp(start[i], end[i]) - start[i]) as usize
            };
            for y in bound(1, 0)..bound(1, 1) {
                reached[y * columns + bound(0, 0)..y * columns + bound(0, 1)].fill(true);
            }
        }
        reached
    }
}

/// The marked pixels of a film as rectangles: runs of a row that go on in the next are one.
fn rectangles(is_marked: &[bool], [start, end]: Pixels) -> Vec<Pixels> {
    let columns = (end[0] - start[0]) as usize;
    let mut done = Vec::new();
    // Runs that go on so far, and the rows where they began.
    let mut open: Vec<([i32; 2], i32)> = Vec::new();
    for y in start[1]..=end[1] {
        let row = (y - start[1]) as usize * columns;
        let row = is_marked.get(row..row + columns).unwrap_or(&[]);
        let mut here = runs(row).map(|run| run.map(|x| x as i32 + start[0]));
        let here: Vec<[i32; 2]> = here.by_ref().collect();
        open.retain(|(run, top)| {
            let goes_on = here.contains(run);
            if !goes_on {
                done.push([[run[0], *top], [run[1], y]]);
            }
            goes_on
        });
        for run in here {
            if open.iter().all(|(known, _)| *known != run) {
                open.push((run, y));
            }
        }
    }
    done
}

/// Where marks of a row begin, and where they are over.
fn runs(row: &[bool]) -> impl Iterator<Item = [usize; 2]> + '_ {
    let begins = |&x: &usize| row[x] && (x == 0 || !row[x - 1]);
    (0..row.len()).filter(begins).map(|from| {
        let length = row[from..].iter().take_while(|m| **m).count();
        [from, from + length]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rectangles cover what is marked, once, and nothing else.
    #[test]
    fn rectangles_cover_what_is_reached() {
        let film = [[-2, -2], [23, 18]];
        let map = DensityMap::new([21, 16], 8, vec![1, 4, 4, 9, 1, 4]);
        assert_eq!(map.all(), [1, 4, 9]);
        for (samples, reach) in [(1, 0), (4, 1), (9, 2)] {
            let reached = map.reached(samples, film, reach);
            let mut covered = vec![0; reached.len()];
            for [start, end] in map.needed(samples, film, reach) {
                for y in start[1]..end[1] {
                    for x in start[0]..end[0] {
                        covered[((y + 2) * 25 + x + 2) as usize] += 1;
                    }
                }
            }
            let as_reached: Vec<_> = reached.iter().map(|r| i32::from(*r)).collect();
            assert_eq!(covered, as_reached, "{samples}");
        }
    }

    /// Each pixel is marked that is near enough to one with the density.
    #[test]
    fn filters_reach_beyond_blocks() {
        let map = DensityMap::new([16, 8], 8, vec![1, 4]);
        let film = [[0, 0], [16, 8]];
        let column = |samples, reach| map.reached(samples, film, reach)[..16].to_vec();
        assert_eq!(column(4, 2), (0..16).map(|x| x >= 6).collect::<Vec<_>>());
        assert_eq!(column(1, 0), (0..16).map(|x| x < 8).collect::<Vec<_>>());
    }
}
