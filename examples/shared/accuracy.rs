//! How runs with standard errors compare with a reference, number by number.

use super::program::ForwardRun;
use crate::Result;

/// Independent groups behind the standard error of one run: so many as `forward` makes of 16, 64 or
/// 256 samples.
pub const GROUPS: f64 = 4.0;

/// Standard errors below this share of the reference's RMS are not taken at their word.
const QUIET: f64 = 1e-3;

/// A gradient image that others are compared with.
pub struct Reference {
    pub values: Vec<f32>,
    /// Standard error of each number; NaN where it is not known.
    pub stderr: Vec<f32>,
    /// Width and height.
    pub size: [usize; 2],
    pub rms: f64,
    /// RMS of the known standard errors, relative to `rms`.
    pub error: f64,
}

impl Reference {
    pub fn new(values: Vec<f32>, stderr: Vec<f32>, size: [usize; 2]) -> Self {
        let rms = rms(values.iter().map(|x| *x as f64));
        let error = self::rms(stderr.iter().filter(|e| e.is_finite()).map(|x| *x as f64)) / rms;
        Self {
            values,
            stderr,
            size,
            rms,
            error,
        }
    }

    /// The mean of independent runs, with the standard error from all groups of all runs together.
    pub fn mean_of(runs: &[ForwardRun]) -> Self {
        let n = runs.len() as f64;
        let number = |i: usize| {
            let mean = runs.iter().map(|r| r.gradient[i] as f64).sum::<f64>() / n;
            let variance = of_group(runs, i, mean) / (n * GROUPS);
            (mean as f32, variance.sqrt() as f32)
        };
        let (values, stderr) = (0..runs[0].gradient.len()).map(number).unzip();
        Self::new(values, stderr, runs[0].size)
    }
}

/// The variance of what one group of samples gives for number `i`: from the spread of the runs
/// about `mean` and from that of each run's groups about the run.
fn of_group(runs: &[ForwardRun], i: usize, mean: f64) -> f64 {
    let squares = |run: &ForwardRun| {
        let (between, within) = (run.gradient[i] as f64 - mean, run.stderr[i] as f64);
        GROUPS * between.powi(2) + GROUPS * (GROUPS - 1.0) * within.powi(2)
    };
    runs.iter().map(squares).sum::<f64>() / (runs.len() as f64 * GROUPS - 1.0)
}

/// How repeated runs compare with a reference.
pub struct Accuracy {
    /// RMS difference of one run, relative to the reference's RMS.
    pub error: f64,
    /// Standard deviation of one run, likewise.
    pub spread: f64,
    /// What averaging leaves, likewise; negative if it is less than the noise of the average.
    pub bias: f64,
    /// Of the average on the reference: 1 if the amplitude is right.
    pub projection: f64,
    /// Stated standard errors over the spread.
    pub stated: f64,
    z: ZScores,
}

#[derive(Default)]
struct ZScores {
    squares: f64,
    beyond_4: usize,
    compared: usize,
    /// Sum of squared differences of the numbers that are not compared by their error bars.
    quiet: f64,
    quiet_count: usize,
    expected_square: f64,
    expected_beyond_4: f64,
}

impl Accuracy {
    pub fn new(runs: &[ForwardRun], reference: &Reference) -> Result<Self> {
        let n = runs.len() as f64;
        let (mut squares, mut variance, mut left, mut product, mut stated) =
            (0.0, 0.0, 0.0, 0.0, 0.0);
        let freedom = n * GROUPS - 1.0;
        let mut z = ZScores {
            // Of a t-distributed number.
            expected_square: freedom / (freedom - 2.0),
            expected_beyond_4: tail(freedom),
            ..ZScores::default()
        };
        for (i, &truth) in reference.values.iter().enumerate() {
            if runs
                .iter()
                .any(|r| r.gradient.len() != reference.values.len())
            {
                return Err("its image is not of the reference's size".into());
            }
            let truth = truth as f64;
            let values = || runs.iter().map(|r| r.gradient[i] as f64);
            let mean = values().sum::<f64>() / n;
            let between = values().map(|x| (x - mean).powi(2)).sum::<f64>();
            let within = runs
                .iter()
                .map(|r| (r.stderr[i] as f64).powi(2))
                .sum::<f64>();
            squares += values().map(|x| (x - truth).powi(2)).sum::<f64>() / n;
            variance += between / (n - 1.0);
            stated += within / n;
            left += (mean - truth).powi(2);
            product += mean * truth;
            z.add(
                mean - truth,
                of_group(runs, i, mean) / (n * GROUPS),
                reference.stderr[i] as f64,
                reference.rms,
            );
        }
        let count = reference.values.len() as f64;
        let scale = reference.rms * count.sqrt();
        let bias = left - variance / n;
        Ok(Self {
            error: squares.sqrt() / scale,
            spread: variance.sqrt() / scale,
            bias: bias.signum() * bias.abs().sqrt() / scale,
            projection: product / (scale * scale),
            stated: (stated / variance).sqrt(),
            z,
        })
    }

    /// χ²/N, and what is expected of it.
    pub fn chi_square(&self) -> [f64; 2] {
        let n = self.z.compared.max(1) as f64;
        [self.z.squares / n, self.z.expected_square]
    }

    /// χ²/N, |z| > 4, …
    pub fn z_cells(&self) -> String {
        let z = &self.z;
        let n = z.compared.max(1) as f64;
        format!(
            "{:.3} | {:.3} | {:.3} % | {:.3} % | {} | {:.1e} of {} | {:.3}",
            z.squares / n,
            z.expected_square,
            100.0 * z.beyond_4 as f64 / n,
            100.0 * z.expected_beyond_4,
            z.compared,
            (z.quiet / z.quiet_count.max(1) as f64).sqrt(),
            z.quiet_count,
            self.stated
        )
    }
}

impl ZScores {
    /// Numbers with error bars below [`QUIET`] have them from few events or from rounding: they are
    /// compared by size. So are those whose reference has no known error.
    fn add(&mut self, difference: f64, variance: f64, reference_error: f64, rms: f64) {
        let variance = variance + reference_error * reference_error;
        if variance.is_nan() || variance <= (QUIET * rms).powi(2) {
            self.quiet += (difference / rms).powi(2);
            self.quiet_count += 1;
            return;
        }
        let z = difference / variance.sqrt();
        self.squares += z * z;
        self.beyond_4 += (z.abs() > 4.0) as usize;
        self.compared += 1;
    }
}

/// The chance that a t-distributed number lies beyond ±4.
fn tail(freedom: f64) -> f64 {
    use statrs::distribution::{ContinuousCDF, StudentsT};
    StudentsT::new(0.0, 1.0, freedom).map_or(f64::NAN, |t| 2.0 * t.sf(4.0))
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
    (sum / n).sqrt()
}
