//! Error against time: slopes, and what nothing else beats in both.

/// The exponent b of y = a·x^b by least squares of the logarithms; none with fewer than two
/// different points that have logarithms.
pub fn exponent(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<(f64, f64)> = points
        .iter()
        .filter(|(x, y)| *x > 0.0 && *y > 0.0)
        .map(|(x, y)| (x.ln(), y.ln()))
        .collect();
    let n = logs.len() as f64;
    let mean_x = logs.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = logs.iter().map(|p| p.1).sum::<f64>() / n;
    let spread: f64 = logs.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    let together: f64 = logs.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    (spread > 0.0).then(|| together / spread)
}

/// Which points no other equals or beats in both coordinates while beating it in one: the smaller
/// the better. What is not finite is never one of them.
pub fn pareto_front(points: &[(f64, f64)]) -> Vec<bool> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    let beats = |a: &(f64, f64), b: &(f64, f64)| {
        finite(a) && a.0 <= b.0 && a.1 <= b.1 && (a.0 < b.0 || a.1 < b.1)
    };
    points
        .iter()
        .map(|point| finite(point) && !points.iter().any(|other| beats(other, point)))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_law_gives_its_exponent() {
        let points: Vec<(f64, f64)> = (1..6)
            .map(|i| (2f64.powi(i), 3.0 * 2f64.powi(-i)))
            .collect();
        assert!((exponent(&points).unwrap() + 1.0).abs() < 1e-12);
        let noise = [
            (1.0, 1.0),
            (4.0, 0.5),
            (0.0, 7.0),
            (16.0, 0.25),
            (3.0, f64::NAN),
        ];
        assert!((exponent(&noise).unwrap() + 0.5).abs() < 1e-12);
        assert_eq!(exponent(&[(1.0, 1.0), (1.0, 2.0)]), None);
        assert_eq!(exponent(&[]), None);
    }

    #[test]
    fn the_front_is_what_nothing_beats() {
        let points = [
            (1.0, 9.0),
            (2.0, 4.0),
            (3.0, 5.0),
            (4.0, 1.0),
            (2.0, 4.0),
            (0.5, f64::NAN),
        ];
        let front = pareto_front(&points);
        assert_eq!(front, [true, true, false, true, true, false]);
    }
}
