//! The mean of independent numbers, and how sure it is.

/// A number and its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub error: f64,
}

impl Estimate {
    /// The mean of independent, equally weighted numbers. The error of one alone is not a number.
    pub fn mean(numbers: &[f64]) -> Self {
        Self::mean_of(numbers.iter().copied())
    }

    /// The same, of numbers that are in no one place.
    pub fn mean_of(numbers: impl Iterator<Item = f64> + Clone) -> Self {
        let n = numbers.clone().count() as f64;
        let value = numbers.clone().sum::<f64>() / n;
        let squares = numbers.map(|x| (x - value).powi(2)).sum();
        Self {
            value,
            error: error_of_mean(squares, n),
        }
    }

    /// Distance from `truth` in standard errors.
    pub fn z(&self, truth: f64) -> f64 {
        (self.value - truth) / self.error
    }
}

/// The standard error of the mean of `n` numbers whose squared distances from it add up to
/// `squares`.
pub fn error_of_mean(squares: f64, n: f64) -> f64 {
    (squares / (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_error_is_that_of_the_mean() {
        let estimate = Estimate::mean_of((0..16).map(f64::from));
        assert_eq!(estimate.value, 7.5);
        assert!((estimate.error - 340f64.sqrt() / 15f64.sqrt() / 4.0).abs() < 1e-15);
        assert_eq!(Estimate::mean(&[3.0; 4]).error, 0.0);
        assert!(Estimate::mean(&[3.0]).error.is_nan());
    }
}
