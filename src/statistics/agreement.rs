//! Whether two kinds of estimates of one image agree, by the scatter of independent runs.

use super::estimate::Estimate;
use super::sigmas::of_student;

/// Noise below this fraction of the gradient's root mean square is rounding: images are stored in
/// single precision, and finite differences divide by a small step.
const ROUNDING: f64 = 2e-3;

/// How far two kinds of estimates of one image are apart, from as many independent runs of each.
#[derive(Clone, Copy, Debug)]
pub struct Agreement {
    /// Mean over pixels of (Σ_r D_r)²/Σ_r D_r², D_r being the difference of the two r-th runs: 1 if
    /// the differences have mean zero, up to the number of runs if they are all bias.
    pub chi_squared: Estimate,
    /// The differences projected on the reference: the relative error of the gradient's size.
    pub bias: Estimate,
    /// Of each.
    runs: usize,
}

impl Agreement {
    /// Of runs that are each a whole image; the second are the reference.
    ///
    /// The signs of the differences D_r are random if there is no bias, and given the |D_r| that
    /// alone is the sampling distribution of χ² = Σ_rs G_rs/Σ_r G_rr with G_rs = Σ_i w_i D_ri D_si:
    /// its mean is 1 and the variance of its numerator 2·Σ_{r≠s} G_rs². No pixel need be normally
    /// distributed, and pixels may depend on each other. The weights are w_i = 1/Σ_q (D_qi² +
    /// rounding²).
    pub fn new(ours: &[Vec<f64>], theirs: &[Vec<f64>]) -> Self {
        let (runs, pixels) = (ours.len(), ours[0].len());
        assert_eq!(runs, theirs.len());
        let total: Vec<f64> = (0..pixels)
            .map(|i| theirs.iter().map(|run| run[i]).sum())
            .collect();
        let norm = dot(&total, &total) / runs as f64;
        let rounding = ROUNDING * ROUNDING * norm / (runs * pixels) as f64;

        let pairs = ours.iter().zip(theirs);
        let differences: Vec<Vec<f64>> = pairs
            .map(|(a, b)| a.iter().zip(b).map(|(a, b)| a - b).collect())
            .collect();
        let square_of = |i: usize| {
            differences
                .iter()
                .map(|d| d[i] * d[i] + rounding)
                .sum::<f64>()
        };
        let weights: Vec<f64> = (0..pixels).map(|i| 1.0 / square_of(i)).collect();
        let gram = |r: usize, s: usize| -> f64 {
            let (a, b) = (&differences[r], &differences[s]);
            (0..pixels).map(|i| weights[i] * a[i] * b[i]).sum()
        };
        let trace: f64 = (0..runs).map(|r| gram(r, r)).sum();
        let lower: Vec<f64> = (0..runs)
            .flat_map(|r| (0..r).map(move |s| (r, s)))
            .map(|(r, s)| gram(r, s))
            .collect();
        let chi_squared = Estimate {
            value: 1.0 + 2.0 * lower.iter().sum::<f64>() / trace,
            error: 2.0 * lower.iter().map(|g| g * g).sum::<f64>().sqrt() / trace,
        };

        // Each difference is projected on the mean of the other reference runs, which it does not
        // depend on.
        let projections: Vec<f64> = (0..runs)
            .map(|r| {
                let others: Vec<f64> = (0..pixels).map(|i| total[i] - theirs[r][i]).collect();
                let share = runs as f64 / (runs - 1) as f64;
                dot(&differences[r], &others) * share / norm
            })
            .collect();
        Self {
            chi_squared,
            bias: Estimate::mean(&projections),
            runs,
        }
    }

    /// Whether both agree within `sigmas` standard errors. That of the bias comes from few runs:
    /// four of twelve are exceeded two times in a thousand (Student), so as many count as are as
    /// rare as these of a normal distribution.
    pub fn holds(&self, sigmas: f64) -> bool {
        let bias = of_student(self.bias.z(0.0), self.runs as f64 - 1.0);
        self.chi_squared.z(1.0) <= sigmas && bias.abs() <= sigmas
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
