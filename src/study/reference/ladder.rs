//! Whether finite differences of ever smaller steps agree with each other.
//!
//! A wide step has less noise, since the noise comes from the few paths whose ends meet something
//! else a step apart; a narrow one less bias. Of two neighbouring steps that agree within their
//! noise both are used.

use crate::statistics::agreement::Agreement;
use crate::statistics::bias::Bias;
use crate::statistics::sigmas;
use serde::{Deserialize, Serialize};

/// Beyond so many sigmas steps disagree.
pub const MOST_SIGMAS: f64 = 4.0;

/// What was found of the steps.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Ladder {
    /// Steps in parts of the usual one.
    pub steps: Vec<f64>,
    /// How far each is from the next.
    pub sigmas: Vec<f64>,
    /// The two that make the reference.
    pub used: [f64; 2],
    /// Whether these two agree.
    pub agrees: bool,
}

impl Ladder {
    /// Takes the widest two steps that agree, or the narrowest two; and the runs of both together,
    /// weighted by what noise they have.
    pub fn climb(
        runs: &[Vec<Vec<f64>>],
        steps: &[f64],
        rounding: impl Fn(f64) -> f64,
    ) -> (Self, Vec<Vec<f64>>) {
        let pairs = runs.windows(2).zip(&steps[1..]);
        let sigmas: Vec<f64> = pairs
            .map(|(pair, step)| between(&pair[0], &pair[1], rounding(*step)))
            .collect();
        let found = sigmas.iter().position(|s| *s < MOST_SIGMAS);
        let at = found.unwrap_or(sigmas.len() - 1);
        let [wide, narrow] = [&runs[at], &runs[at + 1]];
        let [a, b] = [wide, narrow].map(|runs| scatter(runs));
        let share = if a + b > 0.0 { b / (a + b) } else { 0.5 };
        let both = wide.iter().zip(narrow).map(|(wide, narrow)| {
            let numbers = wide.iter().zip(narrow);
            numbers
                .map(|(w, n)| share * w + (1.0 - share) * n)
                .collect()
        });
        let ladder = Self {
            steps: steps.to_vec(),
            sigmas,
            used: [steps[at], steps[at + 1]],
            agrees: found.is_some(),
        };
        (ladder, both.collect())
    }
}

/// How far two sets of as many runs are from each other, in sigmas: as images, or in their size.
/// Where they differ by no more than rounding, nothing.
pub fn between(ours: &[Vec<f64>], theirs: &[Vec<f64>], rounding: f64) -> f64 {
    let runs = ours.len().min(theirs.len());
    let apart = |i: usize| (0..runs).any(|r| (ours[r][i] - theirs[r][i]).abs() > rounding);
    // Numbers that never differ have no weight to be compared by.
    let compared: Vec<usize> = (0..ours[0].len()).filter(|i| apart(*i)).collect();
    if compared.is_empty() {
        return 0.0;
    }
    let picked = |all: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let of = |run: &Vec<f64>| compared.iter().map(|i| run[*i]).collect();
        all[..runs].iter().map(of).collect()
    };
    let (ours, theirs) = (picked(ours), picked(theirs));
    let image = Bias::new(&ours, &theirs).sigmas();
    let size = Agreement::new(&ours, &theirs).bias.z(0.0);
    let size = sigmas::of_student(size, runs as f64 - 1.0).abs();
    // A size without a scatter is no number.
    [image, size]
        .into_iter()
        .filter(|s| s.is_finite())
        .fold(0.0, f64::max)
}

/// The squares of what runs are from their mean.
fn scatter(runs: &[Vec<f64>]) -> f64 {
    let n = runs.len() as f64;
    let of_number = |i: usize| {
        let mean = runs.iter().map(|run| run[i]).sum::<f64>() / n;
        runs.iter().map(|run| (run[i] - mean).powi(2)).sum::<f64>()
    };
    (0..runs[0].len()).map(of_number).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs about `mean` with a scatter that no generator need make: a hash of where they are.
    fn runs(mean: f64, sd: f64, seed: u64) -> Vec<Vec<f64>> {
        let noise = |i: u64| {
            let mixed = (i ^ seed << 32).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let mixed = (mixed ^ mixed >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            (mixed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let number =
            |r: u64, i: u64| mean * (1.0 + i as f64) + sd * 12f64.sqrt() * noise(99 * r + i);
        (0..24)
            .map(|r| (0..50).map(|i| number(r, i)).collect())
            .collect()
    }

    #[test]
    fn steps_that_are_too_wide_are_left_out() {
        let steps = [1.0, 0.5, 0.25];
        let all = [runs(1.2, 1.0, 1), runs(1.0, 2.0, 2), runs(1.0, 4.0, 3)];
        let (ladder, both) = Ladder::climb(&all, &steps, |_| 0.0);
        assert!(ladder.sigmas[0] > MOST_SIGMAS, "{ladder:?}");
        assert!(ladder.agrees && ladder.used == [0.5, 0.25], "{ladder:?}");
        // Weighted 4 to 1: a variance of 3.2 for each number.
        let sd = (scatter(&both) / 50.0 / 23.0).sqrt();
        assert!((sd - 3.2f64.sqrt()).abs() < 0.15, "{sd}");
        let (ladder, _) =
            Ladder::climb(&[runs(1.0, 1.0, 1), runs(2.0, 1.0, 2)], &[1.0, 0.5], |_| {
                0.0
            });
        assert!(!ladder.agrees);
        // What differs by rounding alone agrees.
        assert_eq!(
            between(&runs(1.0, 0.0, 1), &runs(1.0 + 1e-9, 0.0, 1), 1e-6),
            0.0
        );
    }
}
