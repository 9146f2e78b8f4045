//! Means with standard errors over independent runs, and whether two kinds of runs agree.

/// A number and its standard error.
#[derive(Clone, Copy, Debug)]
pub struct Estimate {
    pub value: f64,
    pub error: f64,
}

impl Estimate {
    /// The mean of independent numbers.
    pub fn mean(samples: &[f64]) -> Self {
        let n = samples.len() as f64;
        assert!(n > 1.0, "one number has no standard error");
        let value = samples.iter().sum::<f64>() / n;
        let squares: f64 = samples.iter().map(|x| (x - value).powi(2)).sum();
        Self {
            value,
            error: (squares / (n - 1.0) / n).sqrt(),
        }
    }

    /// Distance from `truth` in standard errors.
    pub fn z(&self, truth: f64) -> f64 {
        (self.value - truth) / self.error
    }
}
