//! How few of many numbers carry what they add up to.

/// Σx⁴·N/(Σx²)²: 3 for normal numbers about zero, N if one of them is all. NaN if all are zero.
pub fn kurtosis(deviations: &[f64]) -> f64 {
    let [squares, fourths] = deviations.iter().fold([0.0, 0.0], |[two, four], x| {
        let square = x * x;
        [two + square, four + square * square]
    });
    fourths * deviations.len() as f64 / (squares * squares)
}

/// The share that the largest one in a thousand have in the sum of numbers that are not negative;
/// at least one number counts. NaN if all are zero.
pub fn share_of_largest(mut numbers: Vec<f64>) -> f64 {
    let count = numbers.len().div_ceil(1000);
    let sum: f64 = numbers.iter().sum();
    numbers.sort_unstable_by(|a, b| b.total_cmp(a));
    numbers.iter().take(count).sum::<f64>() / sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kurtosis_has_its_closed_forms() {
        // Two points: 1. Uniform on a grid of 2n+1 about zero: (3n²+3n−1)·3/(5n(n+1)).
        assert_eq!(kurtosis(&[-2.0, 2.0, 2.0, -2.0]), 1.0);
        let n = 50.0;
        let uniform: Vec<f64> = (-50..=50).map(f64::from).collect();
        let known = 3.0 * (3.0 * n * n + 3.0 * n - 1.0) / (5.0 * n * (n + 1.0));
        assert!((kurtosis(&uniform) - known).abs() < 1e-12);
        let mut alone = vec![0.0; 100];
        alone[7] = -3.0;
        assert_eq!(kurtosis(&alone), 100.0);
        assert!(kurtosis(&[0.0]).is_nan());
    }

    #[test]
    fn the_largest_in_a_thousand() {
        let mut numbers = vec![1.0; 1998];
        numbers.extend([999.0, 999.0]);
        assert_eq!(share_of_largest(numbers), 0.5);
        assert_eq!(share_of_largest(vec![3.0, 1.0]), 0.75);
    }
}
