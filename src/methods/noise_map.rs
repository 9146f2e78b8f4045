//! Where a gradient image has its noise, and how densely its film is best sampled for it.
//!
//! With n(x) samples a pixel the variance of an image is Σ v(x)/n(x), if v is that of one sample,
//! and its work Σ w(x) n(x). For the same work the variance is least where n goes as √(v/w). A
//! pilot knows v from few samples and overlooks what is rare, so half of the work is spent evenly
//! all the same.
//!
//! What chance leaves on the film itself, as along an outline, falls sooner than with 1/n, with its
//! power of 3/2 about. So fewer samples are taken to cost that much, and more to bring no more than
//! 1/n.

use crate::paths::counts::Counts;
use crate::paths::film::density::DensityMap;
use crate::paths::film::lattice::Pixels;
use crate::picture::Image;

/// Pixels along the sides of blocks.
const SIDE: usize = 8;
/// Blocks may be put together, so many by so many: the filters of all pixels reach beyond their
/// block, where samples are spent for them alone.
const TOGETHER: [usize; 3] = [1, 2, 4];
/// The share of the work that is spent evenly.
const EVENLY: f64 = 0.5;
/// The part of a block's variance that is taken to be chance.
const SPREAD: f64 = 0.25;
/// The densities over an even one, about.
const LADDER: [f64; 6] = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0];
/// What promises less is not done.
const WORTHWHILE: f64 = 1.25;
/// Halvings of the interval in which the density is looked for.
const STEPS: usize = 16;

/// Whether to look where on the film the noise lies.
#[derive(Clone, Copy, PartialEq)]
pub enum Survey {
    None,
    /// If it pays to sample the film unevenly.
    IfItPays,
    /// In any case, since what pays depends on an objective.
    Always,
}

/// Variance and work over the film, by blocks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NoiseMap {
    /// The film in pixels.
    size: [usize; 2],
    /// Of the blocks' pixels together, of few samples of each.
    blocks: Grid,
}

/// A density, and what it brings.
pub struct Plan {
    pub density: DensityMap,
    /// The variance of an even film of as much work over that with this density, about.
    pub gain: f64,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct Grid {
    columns: usize,
    blocks: Vec<Noise>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Noise {
    pixels: f64,
    variance: f64,
    work: f64,
}

impl NoiseMap {
    /// That of a pilot's gradient image with these standard errors, as far as it has looked;
    /// `work_of` tells the work of what was done in a tile.
    pub fn new(
        stderr: &Image,
        tiles: &[(Pixels, Counts)],
        work_of: impl Fn(&Counts) -> f64,
    ) -> Self {
        let size = [stderr.width, stderr.height];
        let mut blocks = Grid::new(size, SIDE);
        let mut seen = vec![false; size[0] * size[1]];
        for ([start, end], counts) in tiles {
            let area = f64::from(end[0] - start[0]) * f64::from(end[1] - start[1]);
            let of_pixel = work_of(counts) / area;
            for y in start[1]..end[1] {
                for x in start[0]..end[0] {
                    // What lies beyond the film is done for those at its rim.
                    let at = [0, 1].map(|i| [x, y][i].clamp(0, size[i] as i32 - 1) as usize);
                    blocks.at(at, SIDE).work += of_pixel;
                    seen[at[1] * size[0] + at[0]] = true;
                }
            }
        }
        let errors = stderr.pixels.iter().enumerate();
        for (i, error) in errors.filter(|(i, _)| seen[*i]) {
            let block = blocks.at([i % size[0], i / size[0]], SIDE);
            block.pixels += 1.0;
            block.variance += error.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>();
        }
        Self { size, blocks }
    }

    /// That of a film of this size with so much variance and work in the pixels of a block, of this
    /// column and row.
    pub fn of_blocks(size: [usize; 2], of_block: impl Fn([usize; 2]) -> [f64; 2]) -> Self {
        let mut blocks = Grid::new(size, SIDE);
        for y in 0..size[1] {
            for x in 0..size[0] {
                let [variance, work] = of_block([x / SIDE, y / SIDE]);
                let block = blocks.at([x, y], SIDE);
                block.pixels += 1.0;
                block.variance += variance;
                block.work += work;
            }
        }
        Self { size, blocks }
    }

    /// The same where pixels count by the square of a derivative of something by them.
    pub fn weighted(&self, adjoint: &Image) -> Self {
        if [adjoint.width, adjoint.height] != self.size {
            return self.clone();
        }
        let mut weights = Grid::new(self.size, SIDE);
        for (i, bar) in adjoint.pixels.iter().enumerate() {
            let square: f64 = bar.iter().map(|b| f64::from(*b).powi(2)).sum();
            weights
                .at([i % self.size[0], i / self.size[0]], SIDE)
                .variance += square;
        }
        let mut weighted = self.clone();
        for (block, weight) in weighted.blocks.blocks.iter_mut().zip(weights.blocks) {
            block.variance *= weight.variance / block.pixels.max(1.0);
        }
        weighted
    }

    /// The density that is best for a film of this size with so many samples of a group in each
    /// pixel, which reach so many pixels; `None` if an even one is about as good.
    pub fn plan(&self, size: [usize; 2], of_group: u32, reach: i32) -> Option<Plan> {
        if size != self.size {
            return None;
        }
        let ladder = ladder(of_group);
        let blocks = self.blocks.smoothed();
        let plans = TOGETHER.iter().filter_map(|&together| {
            let grid = blocks.put_together(together);
            let side = SIDE * together;
            let (samples, gain) = grid.best(&ladder, of_group, f64::from(reach) / side as f64)?;
            let density = DensityMap::new(size, side, samples);
            Some(Plan { density, gain })
        });
        let best = plans.max_by(|a, b| a.gain.total_cmp(&b.gain));
        best.filter(|plan| plan.gain > WORTHWHILE)
    }
}

impl Grid {
    fn new(size: [usize; 2], side: usize) -> Self {
        let columns = size[0].div_ceil(side);
        let blocks = vec![Noise::default(); columns * size[1].div_ceil(side)];
        Self { columns, blocks }
    }

    fn at(&mut self, pixel: [usize; 2], side: usize) -> &mut Noise {
        let [x, y] = pixel.map(|p| p / side);
        &mut self.blocks[y * self.columns + x]
    }

    /// The blocks around one, those beside it first.
    fn around(&self, block: usize) -> impl Iterator<Item = (usize, bool)> + '_ {
        let rows = self.blocks.len() / self.columns;
        let (x, y) = (block % self.columns, block / self.columns);
        let steps = [
            (0, 1),
            (1, 0),
            (2, 1),
            (1, 2),
            (0, 0),
            (2, 0),
            (0, 2),
            (2, 2),
        ];
        let all = steps.into_iter().enumerate();
        all.filter_map(move |(i, (dx, dy))| {
            let (x, y) = ((x + dx).checked_sub(1)?, (y + dy).checked_sub(1)?);
            (x < self.columns && y < rows).then_some((y * self.columns + x, i < 4))
        })
    }

    /// With a part of each variance spread over the blocks around, as chance might have.
    fn smoothed(&self) -> Self {
        let mut smoothed = self.clone();
        for (i, block) in smoothed.blocks.iter_mut().enumerate() {
            let around = self.around(i).map(|(other, _)| other).chain([i]);
            let (mut variance, mut pixels) = (0.0, 0.0);
            for other in around {
                variance += self.blocks[other].variance;
                pixels += self.blocks[other].pixels;
            }
            let evened = variance / pixels.max(1.0) * block.pixels;
            block.variance += SPREAD * (evened - block.variance);
        }
        smoothed
    }

    /// Of so many blocks by so many each one.
    fn put_together(&self, together: usize) -> Self {
        let rows = self.blocks.len() / self.columns;
        let mut larger = Self::new([self.columns, rows], together);
        for (i, block) in self.blocks.iter().enumerate() {
            let sum = larger.at([i % self.columns, i / self.columns], together);
            sum.pixels += block.pixels;
            sum.variance += block.variance;
            sum.work += block.work;
        }
        larger
    }

    /// The samples of a group in each block, of these that there may be and with no more work than
    /// `even` ones take, and the gain by them; what reaches a block from beside it lies so many
    /// sides away.
    fn best(&self, ladder: &[u32], even: u32, reach: f64) -> Option<(Vec<u32>, f64)> {
        let wanted: Vec<f64> = self.blocks.iter().map(Noise::wanted).collect();
        let work: f64 = self.blocks.iter().map(|block| block.work).sum();
        let mean = self.blocks.iter().zip(&wanted).map(|(b, d)| b.work * d);
        let mean = mean.sum::<f64>() / work;
        if !(mean.is_finite() && mean > 0.0) {
            return None;
        }
        let densities = |scale: f64| -> Vec<f64> {
            let wanted = wanted.iter().map(|d| EVENLY + (1.0 - EVENLY) * d / mean);
            let all = wanted.map(|d| nearest(ladder, scale * d * f64::from(even)));
            all.map(|samples| f64::from(samples) / f64::from(even))
                .collect()
        };
        let [mut low, mut high] = [0.25, 4.0];
        for _ in 0..STEPS {
            let scale = f64::sqrt(low * high);
            match self.work(&densities(scale), reach) <= work {
                true => low = scale,
                false => high = scale,
            }
        }
        let densities = densities(low);
        if self.work(&densities, reach) > work {
            return None;
        }
        let [mut before, mut after] = [0.0; 2];
        for (block, density) in self.blocks.iter().zip(&densities) {
            before += block.variance;
            after += block.variance / density.min(density.powf(1.5));
        }
        let samples = densities
            .iter()
            .map(|d| (d * f64::from(even)).round() as u32);
        Some((samples.collect(), before / after))
    }

    /// With margins along blocks of other densities.
    fn work(&self, densities: &[f64], reach: f64) -> f64 {
        let mut work = 0.0;
        for (i, &own) in densities.iter().enumerate() {
            work += own * self.blocks[i].work;
            for (other, is_beside) in self.around(i).filter(|(o, _)| densities[*o] != own) {
                let part = if is_beside { reach } else { reach * reach };
                work += own * part.min(1.0) * self.blocks[other].work;
            }
        }
        work
    }
}

impl Noise {
    /// The best density up to a factor.
    fn wanted(&self) -> f64 {
        let wanted = (self.variance / self.work).sqrt();
        if wanted.is_finite() { wanted } else { 0.0 }
    }
}

/// The samples of a group that there may be in a pixel, rising. Other than even ones are square
/// numbers, whose lattices are as fine along both axes.
fn ladder(even: u32) -> Vec<u32> {
    let square = |samples: f64| (samples.sqrt().round() as u32).max(1).pow(2);
    let rungs = LADDER.iter().map(|&by| match by {
        1.0 => even,
        _ => square(by * f64::from(even)),
    });
    let mut ladder: Vec<u32> = rungs.collect();
    ladder.sort_unstable();
    ladder.dedup();
    ladder
}

/// The nearest of them, by its ratio to what is wanted.
fn nearest(ladder: &[u32], wanted: f64) -> u32 {
    let distance = |samples: &u32| (f64::from(*samples) / wanted).ln().abs();
    let nearest = ladder
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    *nearest.expect("one rung at least")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [128, 128];

    /// Of 16 × 16 blocks these have other variance and work than 1e-4 and 1.
    fn map(others: &[([usize; 2], [f64; 2])]) -> NoiseMap {
        NoiseMap::of_blocks(SIZE, |at| {
            let other = others.iter().find(|(place, _)| *place == at);
            other.map_or([1e-4, 1.0], |(_, noise)| *noise)
        })
    }

    /// The work of a plan over that of an even film: exactly, by its pixels.
    fn work(noise: &NoiseMap, plan: &Plan, even: u32, reach: i32) -> f64 {
        let film = [[0, 0], SIZE.map(|s| s as i32)];
        let mut work = 0.0;
        for samples in plan.density.all() {
            for [start, end] in plan.density.needed(samples, film, reach) {
                for y in start[1]..end[1] {
                    for x in start[0]..end[0] {
                        let mut blocks = noise.blocks.clone();
                        let block = *blocks.at([x as usize, y as usize], SIDE);
                        work += f64::from(samples) / f64::from(even) * block.work / block.pixels;
                    }
                }
            }
        }
        let whole: f64 = noise.blocks.blocks.iter().map(|block| block.work).sum();
        work / whole
    }

    /// Much is gained where the noise lies in one place, for no more work.
    #[test]
    fn samples_go_where_the_noise_is() {
        let noise = map(&[([5, 6], [1.0, 1.0]), ([6, 6], [1.0, 3.0])]);
        for (even, reach) in [(16, 0), (16, 2), (4, 2)] {
            let plan = noise.plan(SIZE, even, reach).expect("a plan");
            let work = work(&noise, &plan, even, reach);
            assert!(plan.gain > 3.0, "{even} {reach}: {}", plan.gain);
            assert!(work <= 1.01, "{even} {reach}: {work}");
        }
    }

    /// An even film stays one, and so does one whose groups have nothing to spare.
    #[test]
    fn even_noise_is_sampled_evenly() {
        assert!(map(&[]).plan(SIZE, 16, 2).is_none());
        let noise = map(&[([5, 6], [1.0, 1.0])]);
        assert!(noise.plan(SIZE, 1, 2).is_none());
        assert!(noise.plan([128, 64], 16, 2).is_none());
    }

    /// What an objective does not ask for is not looked for.
    #[test]
    fn an_objective_counts() {
        let noise = map(&[([5, 6], [1.0, 1.0]), ([12, 2], [1.0, 1.0])]);
        let mut adjoint = Image {
            width: SIZE[0],
            height: SIZE[1],
            pixels: vec![[0.0; 3]; SIZE[0] * SIZE[1]],
        };
        adjoint.pixels[(6 * SIDE + 1) * SIZE[0] + 5 * SIDE + 2] = [1.0, -2.0, 0.5];
        let weighted = noise.weighted(&adjoint);
        let blocks = weighted.blocks.blocks.iter().filter(|b| b.variance > 0.0);
        assert_eq!(blocks.count(), 1);
        let plain = noise.plan(SIZE, 16, 2).expect("a plan").gain;
        assert!(weighted.plan(SIZE, 16, 2).expect("a plan").gain > plain);
    }
}
