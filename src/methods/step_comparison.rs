//! Whether differences over steps of two lengths are one gradient.
//!
//! A difference is the derivative as far as what changes does so in proportion to the step. Where
//! something passes within the step, as a floor that is seen nearly from its side and turns out of
//! sight, it is another number altogether, and its standard error knows nothing of that. But then
//! the two differences that each derivative is made of (`super::steps`) are not alike, either: what
//! jumps by J within the shorter step h makes J/(2h) of the one and J/(2rh) of the other, which are
//! 1 − 1/r of the gradient apart. What is only blurred is less so: where D(4h) lacks 0.7 of the
//! gradient of a wave on the film, D(h) lacks 0.06, most of which is taken off.

use super::displaced_images::DisplacedImages;
use crate::picture::Image;
use crate::statistics::comparison::{Comparison, PICTURE_ROUNDING};
use crate::statistics::estimate::Estimate;
use crate::statistics::replicates::Replicates;

/// Parts of the samples, whose scatter says how sure a difference is.
const PARTS: usize = 4;
/// Standard errors by which differences have to be apart to be called so.
const SIGMAS: f64 = 4.0;
/// Pixels that are kept at most, so that large images take no more memory: beyond that pixels are
/// added up in squares.
const PIXELS: usize = 1 << 16;
/// What the longer step may lack, as a part of what it lacks of a jump.
const TOLERANCE: f64 = 0.93;

/// Differences by steps of two lengths, the shorter first.
#[derive(Default)]
pub struct StepComparison {
    differences: Vec<Parts>,
}

/// A difference by parts of the samples.
struct Parts {
    /// Pixels along a square that counts as one, and such squares along the image.
    square: usize,
    size: [usize; 2],
    /// Sums over groups, and of how many.
    sums: Vec<Vec<[f64; 3]>>,
    groups: Vec<usize>,
    /// One over the distance of its two images.
    per_step: f64,
    /// What rounding of images leaves.
    rounding: f64,
}

impl StepComparison {
    /// Adds the images of one displaced scene.
    pub fn add(&mut self, it: &DisplacedImages) {
        if it.difference == self.differences.len() {
            self.differences.push(Parts::new(it));
        }
        self.differences[it.difference].add(it);
    }

    /// How far they are apart, as a part of the gradient, if that is more than may be.
    pub fn apart(&self) -> Option<f64> {
        let [shorter, longer] = self.differences.as_slice() else {
            return None;
        };
        if shorter.sums.len() < 2 {
            return None;
        }
        let rounding = shorter.rounding.max(longer.rounding);
        let compared = Comparison::of(&longer.replicates(), &shorter.replicates(), rounding);
        let apart = compared
            .relative_bias
            .abs()
            .max(compared.blocks.relative_rms);
        let of_jump = 1.0 - longer.per_step / shorter.per_step;
        (!compared.agrees(SIGMAS, TOLERANCE * of_jump)).then_some(apart)
    }

    /// That in words, the same for all runs.
    pub fn warning(&self) -> Option<&'static str> {
        self.apart().map(|_| {
            "finite differences over the two steps are far apart: what moves passes something within a step, so that \
             neither may be the derivative; --method reparam has no step"
        })
    }
}

impl Parts {
    fn new(it: &DisplacedImages) -> Self {
        let parts = it.groups.len().min(PARTS);
        let pixels = it.size[0] * it.size[1];
        let square = (pixels as f64 / PIXELS as f64).sqrt().ceil().max(1.0) as usize;
        let size = it.size.map(|side| side.div_ceil(square));
        Self {
            square,
            size,
            sums: vec![vec![[0.0; 3]; size[0] * size[1]]; parts],
            groups: vec![0; parts],
            per_step: it.per_step.abs(),
            rounding: 0.0,
        }
    }

    /// Adds one of the two images, whose difference it is.
    fn add(&mut self, it: &DisplacedImages) {
        let parts = self.sums.len();
        let mut brightest = 0.0_f32;
        for (group, image) in it.groups.iter().enumerate() {
            self.groups[group % parts] += usize::from(it.per_step > 0.0);
            let sums = &mut self.sums[group % parts];
            for (i, value) in image.iter().enumerate() {
                let [x, y] = [i % it.size[0], i / it.size[0]].map(|at| at / self.square);
                let sum = &mut sums[y * self.size[0] + x];
                for (sum, value) in sum.iter_mut().zip(value) {
                    *sum += it.per_step * f64::from(*value);
                    brightest = brightest.max(value.abs());
                }
            }
        }
        let rounding = PICTURE_ROUNDING * f64::from(brightest) * it.per_step.abs();
        self.rounding = self.rounding.max(rounding);
    }

    /// Its parts as runs, each as sure as all.
    fn replicates(&self) -> Replicates {
        let mean = |part: usize, i: usize, c: usize| {
            self.sums[part][i][c] / self.groups[part].max(1) as f64
        };
        let parts = 0..self.sums.len();
        let [width, height] = self.size;
        let image = |number: &dyn Fn(usize, usize) -> f64| Image {
            width,
            height,
            pixels: (0..width * height)
                .map(|i| [0, 1, 2].map(|c| number(i, c) as f32))
                .collect(),
        };
        let of_one = (self.sums.len() as f64).sqrt();
        let stderr = image(&|i, c| {
            let numbers = parts.clone().map(|part| mean(part, i, c));
            Estimate::mean_of(numbers).error * of_one
        });
        let mut replicates = Replicates::default();
        for part in parts.clone() {
            replicates.add(&image(&|i, c| mean(part, i, c)), &stderr);
        }
        replicates
    }
}
