//! Samples have the distributions their densities claim: χ² tests with fixed seeds.
//!
//! All tests together reject a right sampler with probability 0.01; each gets its share by Šidák's
//! formula. Points of one stream are stratified, which χ² would call too good: every point here
//! comes from a stream of its own.

mod bounces;
mod lights;
mod lines;
mod lobes;
mod normals;
mod pieces;
mod sky;
mod streams;

use statrs::distribution::{ChiSquared, ContinuousCDF};
use warpath::lanes::LANES;
use warpath::paths::random::Stream;

const ALPHA: f64 = 0.01;
/// How many χ² tests this file makes.
const TESTS: i32 = 118;
const SAMPLES: usize = 1 << 17;
/// Bins that expect fewer are put together.
const LEAST_EXPECTED: f64 = 10.0;
/// What integrals of densities over bins may lack. In a bin of a thousand it is a sixth of the
/// noise.
const MOST_BY_QUADRATURE: f64 = 5e-3;

/// Panics if counts are too far from what was expected.
fn chi_squared(what: &str, counts: &[usize], expected: &[f64]) {
    assert_eq!(counts.len(), expected.len());
    let mut order: Vec<usize> = (0..counts.len()).collect();
    order.sort_by(|a, b| expected[*a].total_cmp(&expected[*b]));
    let (mut statistic, mut bins) = (0.0, 0);
    let (mut count, mut expects) = (0.0, 0.0);
    let last = order.len() - 1;
    for (place, bin) in order.into_iter().enumerate() {
        count += counts[bin] as f64;
        expects += expected[bin];
        if expects == 0.0 {
            assert_eq!(count, 0.0, "{what}: samples where none can be");
        } else if expects >= LEAST_EXPECTED || place == last {
            statistic += (count - expects).powi(2) / expects;
            bins += 1;
            (count, expects) = (0.0, 0.0);
        }
    }
    let tail = ChiSquared::new(f64::from(bins - 1))
        .expect("two bins or more")
        .sf(statistic);
    let share = 1.0 - (1.0 - ALPHA).powf(1.0 / f64::from(TESTS));
    println!("{what}: χ² {statistic:.1} with {bins} bins, p = {tail:.3}");
    assert!(
        tail >= share,
        "{what}: χ² {statistic:.1} with {bins} bins, p = {tail:e}"
    );
}

/// The same number expected in every bin.
fn uniform(what: &str, counts: &[usize]) {
    let share = counts.iter().sum::<usize>() as f64 / counts.len() as f64;
    chi_squared(what, counts, &vec![share; counts.len()]);
}

/// A share of all samples expected in each bin: densities integrated, so their sum must be 1 as
/// well.
fn expect_shares(what: &str, counts: &[usize], shares: &[f64]) {
    let sum: f64 = shares.iter().sum();
    assert!(
        (sum - 1.0).abs() < MOST_BY_QUADRATURE,
        "{what}: the density integrates to {sum}"
    );
    let all = counts.iter().sum::<usize>() as f64;
    // Of a bin that the support just touches, the integral may see nothing.
    let expected: Vec<f64> = shares.iter().map(|s| (s / sum * all).max(1e-3)).collect();
    chi_squared(what, counts, &expected);
}

/// Bin of a number in [0, 1).
fn bin(x: f32, bins: usize) -> usize {
    assert!((0.0..1.0).contains(&x), "{x} is no fraction");
    (x * bins as f32) as usize
}

/// A pair of numbers of many streams: `dimension`, at the lattice point `index`.
fn pairs(seed: u64, dimension: u32, index: u32) -> impl Iterator<Item = [f32; 2]> {
    (0..SAMPLES as u32).map(move |i| {
        let (x, y) = Stream::new(seed, [i / 512, i % 512]).pair(&[index; LANES], dimension);
        [x.to_array()[0], y.to_array()[0]]
    })
}
