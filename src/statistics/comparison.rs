//! Statistics of gradient images: how far two estimates are from each other, in their own error
//! bars.

use super::replicates::Replicates;
use super::sigmas::of_chi_squared;
use crate::picture::Image;
use serde::Serialize;

/// Of the brightest pixel: what rounding leaves in the difference of two images.
pub const PICTURE_ROUNDING: f64 = 1e-6;

/// Differences below this share of the largest number are rounding, which has no error bar.
const ROUNDING: f64 = 1e-4;

/// Pixels whose noise is as if it were one number's: what a filter makes alike.
const ALIKE: f64 = 4.0;

/// Two independent estimates of one gradient image, compared.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    pub tested_runs: usize,
    pub reference_runs: usize,
    /// ⟨value − reference, reference⟩ / ⟨reference, reference⟩, freed of the reference's own noise.
    pub relative_bias: f64,
    pub relative_bias_se: f64,
    /// How much of the variance behind `relative_bias_se` is the reference's.
    pub reference_noise_share: f64,
    /// The means of blocks of pixels, against each other.
    pub blocks: Excess,
    /// The pixels, against each other.
    pub pixels: Excess,
    /// Numbers (pixels × channels) where either estimate has anything to say.
    pub compared: usize,
    /// Σz²/N: 1 if they agree, the error bars are right and the noise is normal; sparse noise is
    /// not.
    pub chi2_per_number: f64,
    /// The share of numbers more than four standard errors apart; 0.00006 for a normal
    /// distribution.
    pub share_beyond_4: f64,
    pub largest_z: f64,
    /// Where `largest_z` is: x, y, channel.
    pub largest_z_at: [usize; 3],
    /// Numbers that differ although both error bars are zero.
    pub certain_differences: usize,
    pub reference_rms: f64,
    /// Whether the reference stands out of its own noise at all.
    pub reference_is_significant: bool,
    /// Whether neither is anything but rounding.
    pub is_zero: bool,
}

/// Difference beyond noise: Σ(difference² − variance), which is zero on average if the two agree.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Excess {
    /// Its root, relative to the reference's RMS.
    pub relative_rms: f64,
    /// In standard errors of a normal distribution that are as rare: where few pixels have all of
    /// the noise this is distributed as χ² of few degrees of freedom.
    pub significance: f64,
}

impl Comparison {
    /// Whether the whole along the reference, and blocks of pixels, agree to a relative tolerance
    /// as far as so many standard errors tell.
    pub fn agrees(&self, sigmas: f64, tolerance: f64) -> bool {
        let bias = self.relative_bias.abs();
        let is_biased = bias > tolerance && bias > sigmas * self.relative_bias_se;
        let Excess {
            relative_rms,
            significance,
        } = self.blocks;
        !is_biased && (significance <= sigmas || relative_rms <= tolerance)
    }

    /// Compares `tested` with `reference`, of one size, whose numbers may be wrong by `rounding` at
    /// least.
    pub fn of(tested: &Replicates, reference: &Replicates, rounding: f64) -> Self {
        let mut sums = Sums::default();
        let mut clusters = vec![[0.0; 3]; tested.block_count()];
        let mut largest = (0.0, 0);
        let magnitude = largest_magnitude(tested).max(largest_magnitude(reference));
        let is_zero = magnitude <= rounding;
        let rounding = rounding.max(ROUNDING * magnitude);
        for (at, ((a, sa), (b, sb))) in tested.numbers().zip(reference.numbers()).enumerate() {
            let variance = sa * sa + sb * sb;
            if variance == 0.0 && a == 0.0 && b == 0.0 {
                continue;
            }
            sums.compared += 1;
            let beyond_rounding = (a - b).abs() > rounding;
            if variance == 0.0 {
                sums.certain += usize::from(beyond_rounding);
            } else {
                let z = (a - b) / variance.sqrt();
                sums.chi2 += z * z;
                sums.beyond += usize::from(z.abs() > 4.0 && beyond_rounding);
                if z.abs() > largest.0 && beyond_rounding {
                    largest = (z.abs(), at);
                }
            }
            sums.ab += a * b;
            sums.bb += b * b;
            sums.noise_b += sb * sb;
            sums.squares += shrunk(a - b, rounding).powi(2);
            sums.variance += variance;
            sums.noise_on_b += variance * b * b;
            sums.reference_noise_on_b += sb * sb * b * b;
            let cluster = &mut clusters[tested.block_of(at)];
            cluster[0] += a * b;
            cluster[1] += b * b - sb * sb;
            cluster[2] += variance;
        }
        let signal = (sums.bb - sums.noise_b).max(0.0);
        let significant = !is_zero && signal > 0.1 * sums.bb;
        // Without a signal nothing is relative to it.
        let scale = if significant { signal } else { f64::NAN };
        let slope = sums.ab / scale;
        // The scatter over blocks holds although neighbouring pixels share samples; the bias itself
        // is out, and with it so much of what may be noise in the signal.
        let scatter: f64 = clusters
            .iter()
            .map(|[ab, bb, _]| (ab - slope * bb).powi(2))
            .sum();
        let chance = (1.0 - slope * slope).max(0.0) * variance_of_signal(reference);
        let within: f64 = clusters.iter().map(|c| 2.0 * c[2] * c[2]).sum();
        let count = sums.compared.max(1) as f64;
        let pixel = largest.1 / 3;
        Self {
            tested_runs: tested.runs(),
            reference_runs: reference.runs(),
            relative_bias: slope - 1.0,
            relative_bias_se: (scatter.max(sums.noise_on_b) + chance).sqrt() / scale,
            reference_noise_share: sums.reference_noise_on_b
                / sums.noise_on_b.max(f64::MIN_POSITIVE),
            blocks: block_excess(tested, reference, rounding, significant),
            // As if all the noise of a block were one number's: the filter correlates neighbours.
            pixels: Excess::new([sums.squares, sums.variance], within, scale),
            compared: sums.compared,
            chi2_per_number: sums.chi2 / count,
            share_beyond_4: sums.beyond as f64 / count,
            largest_z: largest.0,
            largest_z_at: [
                pixel % tested.width().max(1),
                pixel / tested.width().max(1),
                largest.1 % 3,
            ],
            certain_differences: sums.certain,
            reference_rms: (signal / tested.numbers().count().max(1) as f64).sqrt(),
            reference_is_significant: significant,
            is_zero,
        }
    }

    /// Whether the error bar of the bias is small enough to tell anything of this size.
    pub fn can_tell(&self, size: f64) -> bool {
        self.is_zero || self.reference_is_significant && self.relative_bias_se <= size
    }
}

#[derive(Default)]
struct Sums {
    compared: usize,
    beyond: usize,
    certain: usize,
    chi2: f64,
    ab: f64,
    bb: f64,
    noise_b: f64,
    squares: f64,
    variance: f64,
    noise_on_b: f64,
    reference_noise_on_b: f64,
}

impl Excess {
    /// From the sums of squared differences and of their variances, and the variance of the former.
    fn new([squares, variance]: [f64; 2], its_variance: f64, scale: f64) -> Self {
        let excess = squares - variance;
        Self {
            relative_rms: (excess.max(0.0) / scale).sqrt(),
            significance: match its_variance > 0.0 {
                true => of_chi_squared(squares / variance, its_variance.sqrt() / variance),
                false if excess > 0.0 => f64::MAX,
                false => 0.0,
            },
        }
    }
}

/// Of Σ(b² − σ²), where b is nothing but noise: 2σ⁴ for a normal number.
fn variance_of_signal(reference: &Replicates) -> f64 {
    let variances: Vec<f64> = reference
        .numbers()
        .map(|(_, error)| error * error)
        .collect();
    let pixels = variances.chunks(3).map(|channels| channels.iter().sum());
    ALIKE
        * pixels
            .map(|variance: f64| 2.0 * variance * variance)
            .sum::<f64>()
}

fn block_excess(
    tested: &Replicates,
    reference: &Replicates,
    rounding: f64,
    significant: bool,
) -> Excess {
    let (mut squares, mut signal) = (0.0, 0.0);
    let mut variances = vec![0.0; tested.block_count()];
    let pairs = tested.block_means().zip(reference.block_means());
    for (number, (a, b)) in pairs.enumerate() {
        squares += shrunk(a.value - b.value, rounding).powi(2);
        // As if all the noise of a block were one channel's: what is bright is so in all of them.
        variances[number / 3] += a.error * a.error + b.error * b.error;
        signal += b.value * b.value - b.error * b.error;
    }
    let variance: f64 = variances.iter().sum();
    // 2·variance² for a normal distribution; an estimated variance's square is too large on
    // average, and the more so the fewer the runs: that errs on the side of agreement.
    let its_variance: f64 = variances.iter().map(|v| 2.0 * v * v).sum();
    let scale = if significant && signal > 0.0 {
        signal
    } else {
        f64::NAN
    };
    Excess::new([squares, variance], its_variance, scale)
}

/// A difference without the part that rounding may have in it.
fn shrunk(difference: f64, rounding: f64) -> f64 {
    (difference.abs() - rounding).max(0.0)
}

/// The difference in standard errors; zero where neither estimate has one.
pub fn z_scores(tested: &Replicates, reference: &Replicates) -> Image {
    let pairs = tested.numbers().zip(reference.numbers());
    tested.image(pairs.map(|((a, sa), (b, sb))| match sa.hypot(sb) {
        0.0 => 0.0,
        error => (a - b) / error,
    }))
}

fn largest_magnitude(replicates: &Replicates) -> f64 {
    let magnitudes = replicates.numbers().map(|(value, _)| value.abs());
    magnitudes.fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
