//! How the mean of runs compares with the mean of others, without what the noise of either adds.

use crate::shared::program::ForwardRun;

/// A number and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub value: f64,
    pub error: f64,
}

/// What comparing gives. Numbers are relative to the reference's RMS, from which its noise is taken
/// too.
#[derive(Clone, Copy, Debug)]
pub struct Agreement {
    /// ⟨mean, reference⟩/⟨reference, reference⟩: 1 if the amplitude is right.
    pub amplitude: Estimate,
    /// Mean square of what averaging ever more runs would leave; below zero by chance.
    pub bias_square: Estimate,
    /// RMS error of one run.
    pub error: f64,
}

impl Agreement {
    /// Both need `LEAST_RUNS`. Standard errors are by the jackknife: each run is left out once.
    pub fn of(runs: &[ForwardRun], reference: &[ForwardRun]) -> Self {
        let (a, b) = (Sums::new(runs), Sums::new(reference));
        let [amplitude, bias_square, spread_square] = figures(&a, None, &b, None);
        let mut variance = [0.0; 2];
        for side in 0..2 {
            let left_out: Vec<[f64; 3]> = match side {
                0 => runs
                    .iter()
                    .map(|r| figures(&a, Some(r), &b, None))
                    .collect(),
                _ => reference
                    .iter()
                    .map(|r| figures(&a, None, &b, Some(r)))
                    .collect(),
            };
            let n = left_out.len() as f64;
            for (k, variance) in variance.iter_mut().enumerate() {
                let mean = left_out.iter().map(|f| f[k]).sum::<f64>() / n;
                let spread = left_out.iter().map(|f| (f[k] - mean).powi(2)).sum::<f64>();
                *variance += (n - 1.0) / n * spread;
            }
        }
        let [amplitude_error, bias_error] = variance.map(f64::sqrt);
        Self {
            amplitude: Estimate {
                value: amplitude,
                error: amplitude_error,
            },
            bias_square: Estimate {
                value: bias_square,
                error: bias_error,
            },
            error: (bias_square.max(0.0) + spread_square).sqrt(),
        }
    }

    /// Its root where it stands out from noise; else what it is below, at two standard errors.
    pub fn bias(&self) -> String {
        let Estimate { value, error } = self.bias_square;
        if value > 2.0 * error {
            let root = value.sqrt();
            format!("{root:.4} ± {:.4}", error / (2.0 * root))
        } else {
            format!("< {:.4}", self.bias_limits()[1])
        }
    }

    /// Two standard errors below and above the bias.
    pub fn bias_limits(&self) -> [f64; 2] {
        let Estimate { value, error } = self.bias_square;
        [-2.0, 2.0].map(|k| (value.max(0.0) + k * error).max(0.0).sqrt())
    }
}

/// Sums over runs, number by number.
struct Sums {
    runs: f64,
    /// Of the values and of their squares.
    numbers: Vec<[f64; 2]>,
}

impl Sums {
    fn new(runs: &[ForwardRun]) -> Self {
        let mut numbers = vec![[0.0; 2]; runs[0].gradient.len()];
        for run in runs {
            for (sums, x) in numbers.iter_mut().zip(&run.gradient) {
                let x = *x as f64;
                *sums = [sums[0] + x, sums[1] + x * x];
            }
        }
        Self {
            runs: runs.len() as f64,
            numbers,
        }
    }

    /// Mean of a number over the runs but one, and the variance of a run.
    fn moments(&self, i: usize, without: Option<&ForwardRun>) -> (f64, f64, f64) {
        let [mut sum, mut squares] = self.numbers[i];
        let mut n = self.runs;
        if let Some(run) = without {
            let x = run.gradient[i] as f64;
            (sum, squares, n) = (sum - x, squares - x * x, n - 1.0);
        }
        let mean = sum / n;
        // Of one run there is no spread.
        let variance = (squares - n * mean * mean).max(0.0) / (n - 1.0).max(1.0);
        (mean, variance, n)
    }
}

/// Amplitude, square of the bias and variance of one run, each without a bias of its own.
fn figures(
    a: &Sums,
    without_a: Option<&ForwardRun>,
    b: &Sums,
    without_b: Option<&ForwardRun>,
) -> [f64; 3] {
    let (mut product, mut power, mut apart, mut spread) = (0.0, 0.0, 0.0, 0.0);
    for i in 0..b.numbers.len() {
        let (mean, variance, n) = a.moments(i, without_a);
        let (truth, noise, m) = b.moments(i, without_b);
        product += mean * truth;
        power += truth * truth - noise / m;
        apart += (mean - truth).powi(2) - variance / n - noise / m;
        spread += variance;
    }
    [product / power, apart / power, spread / power]
}
