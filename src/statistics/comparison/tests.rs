//! The comparison must say yes to equals under noise and no to each kind of fault.

use super::*;

const SIDE: usize = 64;
const RUNS: usize = 8;
/// Of the mean of all runs.
const NOISE: f64 = 0.02;

/// Normal numbers from a counter (a sum of twelve uniform ones is near enough).
fn normal(seed: u64, at: usize) -> f64 {
    let mut state = seed
        .wrapping_mul(0x9e37_79b9_7f4a_7c15)
        .wrapping_add(at as u64);
    let uniform = |state: &mut u64| {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    };
    state = state.wrapping_mul(0x2545_f491_4f6c_dd1d);
    (0..12).map(|_| uniform(&mut state)).sum::<f64>() - 6.0
}

fn image(number: impl Fn(usize) -> f64) -> Image {
    let numbers: Vec<f32> = (0..SIDE * SIDE * 3).map(|at| number(at) as f32).collect();
    Image {
        width: SIDE,
        height: SIDE,
        pixels: numbers.as_chunks::<3>().0.to_vec(),
    }
}

/// A ring of positive and negative derivative on nothing.
fn truth(at: usize) -> f64 {
    let (x, y) = ((at / 3 % SIDE) as f64 - 32.0, (at / 3 / SIDE) as f64 - 32.0);
    if (x.hypot(y) - 20.0).abs() < 3.0 {
        x / 20.0
    } else {
        0.0
    }
}

fn replicates(
    seed: u64,
    value: &impl Fn(usize) -> f64,
    noise: &impl Fn(usize) -> f64,
) -> Replicates {
    let mut replicates = Replicates::default();
    let scale = (RUNS as f64).sqrt();
    for run in 0..RUNS as u64 {
        replicates.add(
            &image(|at| value(at) + scale * noise(at) * normal(seed + run, at)),
            &image(|at| scale * noise(at)),
        );
    }
    replicates
}

fn compare(tested: impl Fn(usize) -> f64) -> Comparison {
    let noise = |at| if truth(at) == 0.0 { 0.0 } else { NOISE };
    Comparison::of(
        &replicates(1, &tested, &noise),
        &replicates(1000, &truth, &noise),
        0.0,
    )
}

#[test]
fn equals_agree() {
    let c = compare(truth);
    assert!((c.chi2_per_number - 1.0).abs() < 0.1, "{c:?}");
    assert!(
        c.share_beyond_4 < 0.002 && c.certain_differences == 0,
        "{c:?}"
    );
    assert!(
        c.relative_bias.abs() < 4.0 * c.relative_bias_se && c.relative_bias_se < 0.01,
        "{c:?}"
    );
    assert!(
        c.blocks.significance.abs() < 4.0 && c.pixels.significance.abs() < 4.0,
        "{c:?}"
    );
    assert!((c.reference_noise_share - 0.5).abs() < 0.01, "{c:?}");
}

#[test]
fn a_bias_is_measured() {
    let c = compare(|at| 0.9 * truth(at));
    assert!(
        (c.relative_bias + 0.1).abs() < 0.01 && c.relative_bias.abs() > 10.0 * c.relative_bias_se,
        "{c:?}"
    );
}

#[test]
fn a_local_fault_is_seen() {
    let c = compare(|at| if at / 3 / SIDE > 48 { 0.0 } else { truth(at) });
    assert!(
        c.share_beyond_4 > 0.02 && c.blocks.significance > 4.0 && c.blocks.relative_rms > 0.1,
        "{c:?}"
    );
    assert!(
        c.pixels.significance > 4.0 && c.pixels.relative_rms > 0.1,
        "{c:?}"
    );
}

#[test]
fn a_shift_by_a_pixel_is_seen_in_the_pixels() {
    let c = compare(|at| truth(at + 3));
    assert!(
        c.pixels.significance > 4.0 && c.pixels.relative_rms > 0.1,
        "{c:?}"
    );
}

/// Something bright that half of the runs of one side have met in one pixel, and none of the other.
#[test]
fn what_is_rare_is_no_fault() {
    let quiet = |at| 0.1 * if truth(at) == 0.0 { 0.0 } else { NOISE };
    let mut tested = Replicates::default();
    let spot = 3 * (32 * SIDE + 32);
    for run in 0..RUNS {
        let met = |at| {
            if at / 3 * 3 == spot && run % 2 == 0 {
                2.0
            } else {
                0.0
            }
        };
        tested.add(
            &image(|at| truth(at) + met(at) + quiet(at) * normal(run as u64, at)),
            &image(|at| quiet(at) + met(at)),
        );
    }
    let c = Comparison::of(&tested, &replicates(1000, &truth, &quiet), 0.0);
    // It is 2.65 standard errors of that pixel.
    assert!((c.blocks.significance - 2.4).abs() < 0.2, "{c:?}");
}

#[test]
fn what_is_certain_must_be_equal() {
    let c = compare(|at| if at < 3 { 1.0 } else { truth(at) });
    assert_eq!(c.certain_differences, 3);
}

#[test]
fn noise_alone_is_no_signal() {
    let c = Comparison::of(
        &replicates(1, &|_| 0.0, &|_| 1.0),
        &replicates(1000, &|_| 0.0, &|_| 1.0),
        0.0,
    );
    assert!(!c.reference_is_significant && !c.is_zero, "{c:?}");
    assert!(c.blocks.significance < 4.0, "{c:?}");
    assert!(!c.can_tell(0.5), "{c:?}");
}

#[test]
fn rounding_alone_is_zero() {
    let tiny = |at: usize| 1e-9 * truth(at);
    let zero = replicates(1, &|_| 0.0, &|_| 0.0);
    let other = replicates(1000, &tiny, &|_| 1e-10);
    let c = Comparison::of(&zero, &other, 1e-8);
    assert!(c.is_zero && c.can_tell(0.03), "{c:?}");
    assert!(!c.reference_is_significant, "nothing is relative to it");
    assert!(
        c.certain_differences == 0 && c.blocks.significance < 4.0,
        "{c:?}"
    );
    assert!(!Comparison::of(&zero, &other, 1e-12).is_zero);
}

/// Where pixels beside one another and all channels share their noise, chance alone may look like a
/// gradient that the other estimate does not have.
#[test]
fn shared_noise_is_no_signal() {
    let noise = |seed: u64, size: f64| {
        let square = |at: usize| at / 3 % SIDE / 2 + at / 3 / SIDE / 2 * SIDE;
        let size = |at: usize| if square(at) % 25 == 3 { size } else { 0.0 };
        let mut replicates = Replicates::default();
        for run in 0..RUNS as u64 {
            let seed = seed * RUNS as u64 + run;
            let noisy = image(|at| size(at) * normal(seed, square(at)));
            replicates.add(&noisy, &image(size));
        }
        replicates
    };
    let pairs = (0..200).map(|i| Comparison::of(&noise(2 * i, 0.1), &noise(2 * i + 1, 1.0), 0.0));
    let told: Vec<_> = pairs.filter(|c| c.reference_is_significant).collect();
    let apart = told.iter().filter(|c| !c.agrees(4.0, 0.1)).count();
    assert!(told.len() > 40 && apart <= 1, "{apart} of {}", told.len());
}
