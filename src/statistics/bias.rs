//! The bias of runs against a reference, apart from the noise of either.

use super::sigmas;

/// The products of the differences between two sets of runs, summed over the numbers of an image.
/// Those of different runs share no noise.
pub struct Bias {
    /// Σ over r ≠ s of ⟨D_r, D_s⟩, D_r being the difference of the two r-th runs.
    between: f64,
    /// What it scatters by if the signs of the D_r are random: see
    /// [`Agreement`](super::agreement::Agreement).
    scatter: f64,
    /// Σ ⟨D_r, D_r⟩.
    within: f64,
    runs: f64,
    numbers: f64,
}

impl Bias {
    /// Of as many runs as both have. All numbers have one weight: weights taken from a number's own
    /// scatter would make a bias of what one side finds rarely and the other always sees a little
    /// of, since where it was not found nothing scatters.
    pub fn new(ours: &[Vec<f64>], theirs: &[Vec<f64>]) -> Self {
        let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| -> Vec<f64> {
            a.iter().zip(b).map(|(a, b)| a - b).collect()
        };
        let all: Vec<Vec<f64>> = ours.iter().zip(theirs).map(difference).collect();
        let product = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let (mut between, mut squares, mut within) = (0.0, 0.0, 0.0);
        for (r, a) in all.iter().enumerate() {
            within += product(a, a);
            for b in &all[..r] {
                let product = product(a, b);
                between += 2.0 * product;
                squares += product * product;
            }
        }
        Self {
            between,
            scatter: 2.0 * squares.sqrt(),
            within,
            runs: all.len() as f64,
            numbers: all[0].len() as f64,
        }
    }

    /// Mean square of the bias, below zero where noise makes it so, and its standard error if there
    /// is none.
    pub fn mean_square(&self) -> (f64, f64) {
        let pairs = self.runs * (self.runs - 1.0) * self.numbers;
        (self.between / pairs, self.scatter / pairs)
    }

    /// How rare this is without a bias, in sigmas of a normal distribution.
    pub fn sigmas(&self) -> f64 {
        let value = 1.0 + self.between / self.within;
        sigmas::of_chi_squared(value, self.scatter / self.within)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One of `n` at random, by where it stands.
    fn chance(at: u64, n: u64) -> bool {
        let mixed = (at + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mixed = (mixed ^ mixed >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ mixed >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ mixed >> 31).is_multiple_of(n)
    }

    #[test]
    fn what_is_found_rarely_is_no_bias() {
        // One side sees 1 in every run, the other 48 in one of 48.
        let seen = |r: u64, i: u64| if chance(1000 * r + i, 48) { 48.0 } else { 0.0 };
        let rare: Vec<Vec<f64>> = (0..24)
            .map(|r| (0..600).map(|i| seen(r, i)).collect())
            .collect();
        let found = Bias::new(&vec![vec![1.0; 600]; 24], &rare);
        let (square, se) = found.mean_square();
        assert!(
            square.abs() < 4.0 * se && found.sigmas() < 4.0,
            "{square} {se}"
        );
        // A bias of two is one, and as large as it is.
        let found = Bias::new(&vec![vec![3.0; 600]; 24], &rare);
        let (square, se) = found.mean_square();
        assert!((square - 4.0).abs() < 4.0 * se.max(0.1), "{square} {se}");
        assert!(found.sigmas() > 4.0, "{}", found.sigmas());
    }
}
