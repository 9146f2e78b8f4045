//! References, errors and z-scores.

use crate::cases::{Case, Options};
use crate::process::{ForwardRun, Program};
use crate::{Result, scratch};
use warpath::output::npy;

/// Independent groups behind the standard error of one run: so many as `forward` makes of 16, 64 or 256 samples.
const GROUPS: f64 = 4.0;

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
    /// The given one, or one by finite differences, made once and kept.
    pub fn read(program: &Program, case: &Case, options: &Options) -> Result<Self> {
        let own = scratch().join("reference");
        let folder = case.given.as_ref().unwrap_or(&own);
        let file = |kind: &str| folder.join(format!("{}.{}{kind}.npy", case.name, case.filter));
        if case.given.is_none() && !file("").exists() {
            std::fs::create_dir_all(folder)?;
            let (mean, stderr, shape) = differences(program, case, options)?;
            npy::write(&file(".stderr"), &shape, stderr)?;
            npy::write(&file(""), &shape, mean)?;
        }
        let (array, stderr) = (npy::read(&file(""))?, npy::read(&file(".stderr"))?.values);
        let &[height, width, 3] = array.shape.as_slice() else {
            return Err("a reference that is no image".into());
        };
        let rms = rms(array.values.iter().map(|x| *x as f64));
        let error = self::rms(stderr.iter().filter(|e| e.is_finite()).map(|x| *x as f64)) / rms;
        Ok(Self {
            values: array.values,
            stderr,
            size: [width, height],
            rms,
            error,
        })
    }
}

type Averaged = (Vec<f32>, Vec<f32>, Vec<usize>);

fn differences(program: &Program, case: &Case, options: &Options) -> Result<Averaged> {
    let (mut sum, mut variance, mut shape) = (Vec::new(), Vec::new(), Vec::new());
    for run in 1..=options.reference_runs {
        eprintln!(
            "{} ({}): reference, run {run} of {}",
            case.name, case.filter, options.reference_runs
        );
        // Seeds that the runs to be judged do not use.
        let (array, stderr) = program.differences(case, options.reference_spp, 1_000_000 + run)?;
        sum.resize(array.values.len(), 0.0f64);
        variance.resize(array.values.len(), 0.0f64);
        for (i, (value, error)) in array.values.iter().zip(&stderr).enumerate() {
            sum[i] += *value as f64;
            variance[i] += (*error as f64).powi(2);
        }
        shape = array.shape;
    }
    let n = options.reference_runs as f64;
    let mean = sum.iter().map(|s| (s / n) as f32).collect();
    let stderr = variance.iter().map(|v| (v.sqrt() / n) as f32).collect();
    Ok((mean, stderr, shape))
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
            // All groups of all runs together.
            let of_group = (between * GROUPS + within * GROUPS * (GROUPS - 1.0)) / freedom;
            z.add(
                mean - truth,
                of_group / (n * GROUPS),
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
    /// Numbers with error bars below [`QUIET`] have them from few events or from rounding: they are compared by size.
    /// So are those whose reference has no known error.
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

/// The middle value.
pub fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    let half = values.len() / 2;
    if values.len() % 2 == 1 {
        values[half]
    } else {
        (values[half - 1] + values[half]) / 2.0
    }
}
